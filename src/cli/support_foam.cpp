#include "cli/support_foam.h"

#include <cstdint>
#include <exception>
#include <fmt/format.h>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "cli/called_commands.h"
#include "cli/hollow_forms.h"
#include "core/drainage.h"
#include "core/error.h"
#include "pipeline/process_choice.h"

namespace aerate::cli {
namespace {

// Passes on whether to stop, and keeps notices: what is told of the stages of `hollow` says nothing of supports.
class TrialMonitor : public Monitor {
 public:
  explicit TrialMonitor(Monitor& inner) : inner_(inner) {}
  void notice(std::string_view text) override { notices.emplace_back(text); }
  void check_interrupted() override { inner_.check_interrupted(); }

  std::vector<std::string> notices;

 private:
  Monitor& inner_;
};

// Without options that it proposes, which are those of `hollow`: "(--hole-diameter 5 leaves ...)".
std::string without_options(std::string notice) {
  for (auto begin = notice.find(" (--"); begin != std::string::npos; begin = notice.find(" (--", begin)) {
    const auto end = notice.find(')', begin);
    notice.erase(begin, end == std::string::npos ? end : end + 1 - begin);
  }
  return notice;
}

struct Rows {
  std::vector<double> vertices;
  std::vector<std::int64_t> triangles;

  explicit Rows(const Mesh& mesh) {
    vertices.reserve(3 * mesh.positions.size());
    triangles.reserve(3 * mesh.triangles.size());
    for (const Vec3f& p : mesh.positions)
      for (const float value : {p.x, p.y, p.z}) vertices.push_back(static_cast<double>(value));
    for (const Triangle& t : mesh.triangles)
      for (const std::uint32_t corner : t) triangles.push_back(corner);
  }
  MeshArrays arrays() const { return {vertices, triangles}; }
};

std::string option(const char* name, double value) {
  return fmt::format("--{}={:g}", name, value);
}

// Arguments of each way to do it, what leaves least first.
std::vector<std::vector<std::string>> ways(Fill fill, const std::string& name, const Limits& given) {
  const Process process = choose_process(name);
  const double wall = process.limits.at(Limit::least_wall).value;
  std::vector<std::string> usual{
      "--process=" + name, fill == Fill::cells ? "--shape=cells" : "--shape=spheres", option("wall", wall),
      option("gap", process.limits.at(Limit::least_gap).value)};
  for (const auto& [limit, figure] : given) {
    const bool has_both = process.limits.contains(Limit::bridge) || given.size() == 2;
    if (has_both) usual.push_back(option(limit == Limit::bridge ? "bridge" : "overhang", figure.value));
  }
  if (process.drainage != Drainage::needed) return {usual};
  usual.emplace_back("--holes-not-on=top");  // there are the teeth, and the model above them
  const auto channel = process.limits.find(Limit::channel);
  if (fill != Fill::cells || channel == process.limits.end()) return {usual};
  // One void in each body, where it is as wide as a channel somewhere: into all that is no narrower than walls have to be, than two of them,
  // or than a channel, since what is less narrow is simpler to drain. Where none takes much, all that `hollow` tries. Below roofs it is less narrow.
  const double radius = channel->second.value / 2;
  const auto single = [&](double fillet) {
    std::vector<std::string> arguments = usual;
    arguments.insert(arguments.end(), {"--max-voids=1", option("min-radius", radius / kWidestTubeShare),
                                       option("fillet", fillet)});
    return arguments;
  };
  if (process.limits.contains(Limit::bridge)) return {single(radius / 2), usual};
  return {single(wall), single(2 * wall), single(radius), usual};
}

// Of a body: other ways are worth their time where less is taken.
constexpr double kEnough = 0.4;

}  // namespace

FoamedBody foamed(const Mesh& body, Fill fill, const std::string& process, const Limits& given,
                  const MayOpen& may_open, Monitor& monitor) {
  const Rows rows(body);
  const MeshArrays arrays = rows.arrays();
  std::optional<Mesh> best;
  std::vector<std::string> notices;
  std::exception_ptr refusal;
  for (const std::vector<std::string>& arguments : ways(fill, process, given)) {
    if (best && signed_volume(*best) <= (1 - kEnough) * signed_volume(body)) break;
    TrialMonitor trial(monitor);
    try {
      Mesh made = hollow_mesh({"supports", &arrays, arguments}, may_open, trial);
      if (best && signed_volume(*best) <= signed_volume(made)) continue;
      best = std::move(made);
      notices = std::move(trial.notices);
    } catch (const Error& error) {
      const bool is_impossible =
          error.code() == ExitCode::nothing_to_remove || error.code() == ExitCode::usage;
      if (!is_impossible) throw;
      refusal = std::current_exception();
    }
  }
  if (!best) std::rethrow_exception(refusal);
  for (const std::string& notice : notices) monitor.notice("voids in supports: " + without_options(notice));
  return {*std::move(best), fill == Fill::cells ? "cells" : "spheres"};
}

}  // namespace aerate::cli
