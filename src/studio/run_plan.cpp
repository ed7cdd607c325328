#include "studio/run_plan.h"

#include <fmt/format.h>
#include <utility>

#include "files/output_file.h"
#include "pipeline/hollow.h"
#include "pipeline/scene_of.h"
#include "view/page.h"

namespace aerate::studio {
namespace {

namespace fs = std::filesystem;

std::string form_of(const fs::path& output) {
  return output.extension().string().substr(1);
}

ResultFile described(const fs::path& file, const std::string& model_name) {
  return {form_of(file), name_of_result(model_name, file.extension().string()), fs::file_size(file)};
}

// The same result in its other form, if it has one: modifiers have none, support blockers are in packages alone.
void write_other_form(const HollowedForm& made, const fs::path& folder, Monitor& monitor) {
  if (made.options->modifiers) return;
  HollowOptions other = *made.options;
  other.output = result_in(folder, form_of(other.output) == "stl" ? "3mf" : "stl");
  other.support_blockers = nullptr;
  static_cast<void>(write_hollowed(made.hollowed, other, monitor));
}

}  // namespace

fs::path result_in(const fs::path& folder, const std::string& form) {
  return folder / fmt::format("{}.{}", kResultStem, form);
}

std::vector<ResultFile> run_plan(const Plan& plan, const std::string& model_name, const fs::path& folder,
                                 const ShownPaths& shown, const Lent& lent, Monitor& monitor) {
  const auto also = [&](const HollowedForm& made, const HollowReport& report, Monitor& stages) {
    write_other_form(made, folder, stages);
    stages.stage("picture");
    Scene scene = scene_of(made.hollowed, report);
    scene.title = model_name;
    write_bytes(page_bytes(scene, "aerate " AERATE_VERSION), fs::path(folder / kSceneFile));
    stages.check_interrupted();
  };
  HollowReport report = hollow(plan.forms, monitor, also);
  report.input.path = model_name;
  report.output_path = plan.output_name;
  for (std::string& notice : report.notices) notice = shown.in(std::move(notice));
  write_bytes(lent.report_json(report), fs::path(folder / kReportFile));
  write_bytes(lent.report_text(report), fs::path(folder / kReportTextFile));
  std::vector<ResultFile> files;
  for (const char* form : {"stl", "3mf", "amf"})
    if (fs::exists(result_in(folder, form))) files.push_back(described(result_in(folder, form), model_name));
  return files;
}

}  // namespace aerate::studio
