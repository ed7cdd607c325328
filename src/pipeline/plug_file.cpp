#include "pipeline/plug_file.h"

#include <fmt/format.h>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/listed.h"
#include "files/formats.h"
#include "printing/plug_surface.h"

namespace aerate {
namespace {

void require_some(const Plugs& plugs, const PlugFit& fit) {
  if (!plugs.plugs.empty()) return;
  throw UsageError(fmt::format("no escape hole has room for a plug of {:g} mm with a clearance of {:g} mm",
                               kShortestPlug, fit.clearance),
                   "give a smaller --plug-clearance or --plug-taper, a larger --wall or --hole-diameter, or "
                   "leave --plugs out");
}

void warn_of_holes_without(const Plugs& plugs, Monitor& monitor) {
  if (plugs.without.empty()) return;
  std::vector<std::string> numbers;
  for (const std::size_t hole : plugs.without) numbers.push_back(fmt::format("{}", hole + 1));
  monitor.notice(fmt::format("{} {} no plug: a hole shorter than {:g} mm on one side has no room for one",
                             numbers.size() == 1 ? "hole" : "holes",
                             listed(numbers, "and") + (numbers.size() == 1 ? " gets" : " get"),
                             kShortestPlug));
}

void warn_of_unnumbered(const Plugs& plugs, Monitor& monitor) {
  std::vector<std::string> numbers;
  for (const Plug& plug : plugs.plugs)
    if (!plug.is_numbered) numbers.push_back(fmt::format("{}", plug.hole + 1));
  if (numbers.empty()) return;
  monitor.notice(fmt::format("{} {} too narrow for a number: tell plugs by their order",
                             numbers.size() == 1 ? "plug" : "plugs",
                             listed(numbers, "and") + (numbers.size() == 1 ? " is" : " are")));
}

}  // namespace

void require_writable(const PlugRequest& request) {
  static_cast<void>(format_to_write(request.output));
}

WrittenPlugs write_plugs(AnnouncedFile& pending, const HollowedModel& hollowed, const PlugRequest& request,
                         Monitor& monitor) {
  WrittenPlugs written;
  written.request = request;
  written.plugs = make_plugs(hollowed.model->mesh, hollowed.surface, hollowed.carved.solid,
                             hollowed.drainage->plan, request.fit);
  require_some(written.plugs, request.fit);
  warn_of_holes_without(written.plugs, monitor);
  warn_of_unnumbered(written.plugs, monitor);
  const MeshFormat& format = format_to_write(request.output);
  write_mesh(written.plugs.mesh, pending.file(), format);
  const Mesh read = read_back(pending.file().path(), format, monitor);
  written.facts = check_plugs(read, written.plugs, request.fit, hollowed.surface, monitor);
  written.bytes = std::filesystem::file_size(pending.file().path());
  return written;
}

}  // namespace aerate
