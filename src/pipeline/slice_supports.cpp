#include "pipeline/slice_supports.h"

#include <chrono>
#include <fmt/format.h>
#include <utility>

#include "core/error.h"
#include "files/formats.h"
#include "files/load.h"
#include "files/output_file.h"
#include "pipeline/announced_file.h"
#include "pipeline/job_log.h"
#include "printing/slicers/child_process.h"
#include "printing/slicers/text_file.h"

namespace aerate {
namespace {

constexpr const char* kOurs = "aerate";

// One run, in a folder of its own.
class Runs {
 public:
  Runs(const Slicer& slicer, const SlicerSettings& settings, std::filesystem::path scratch)
      : slicer_(slicer),
        settings_(settings),
        scratch_(std::move(scratch)),
        place_(place_for(slicer, settings)) {}

  std::filesystem::path gcode_of(const std::string& name) const { return scratch_ / name / "out.gcode"; }

  // `more`: settings that go before the others
  SupportedForm slice_as(const std::string& name, const std::filesystem::path& model,
                         const std::vector<PartSetting>& more, Monitor& monitor) const {
    const std::filesystem::path folder = scratch_ / name;
    std::filesystem::create_directories(folder / "files");
    SliceJob job;
    job.model = model;
    job.gcode = gcode_of(name);
    job.settings = settings_;
    job.place = place_;
    job.scratch = folder / "files";
    if (!more.empty()) {
      std::string lines;
      for (const PartSetting& setting : more) lines += setting.key + " = " + setting.value + "\n";
      write_bytes(lines, folder / "supports.ini");
      job.settings.files.push_back(folder / "supports.ini");
    }
    monitor.stage("slice " + name);
    const auto began = std::chrono::steady_clock::now();
    SupportedForm form{name, slice(slicer_, job, monitor), 0};
    form.slicer_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
    return form;
  }

 private:
  const Slicer& slicer_;
  const SlicerSettings& settings_;
  std::filesystem::path scratch_;
  std::optional<BedPlace> place_;
};

void require_gcode_name(const std::filesystem::path& output) {
  if (is_a_models_name(output))
    throw UsageError(output.string() + ": a model's name, and what is written is G-code",
                     "give a name such as " + output.stem().string() + ".gcode");
}

}  // namespace

SliceSupportsReport slice_supports(const SliceSupportsOptions& options, Monitor& monitor) {
  require_gcode_name(options.output);
  const SlicerProfile& profile = *options.slicer;
  if (!profile.modifiers || profile.modifiers->support_settings.empty())
    throw UsageError(fmt::format("{} reads no supports as a part", profile.name),
                     "write them with 'aerate support', and load both in the slicer");
  if (!require_support_rules(options.support.process, options.support.given).is_filament)
    throw UsageError(fmt::format("--supports: {} does not print what a slicer of filament makes",
                                 options.support.process.name),
                     "make supports by 'aerate support', or give --process fdm");
  SliceSupportsReport report;
  report.model = options.support.model;
  report.output = options.output;
  report.slicer = find_slicer(profile, options.slicer_path);
  require_settings(options.settings, profile);

  JobLog log(monitor);
  AnnouncedFile pending(options.output, log);
  const PrivateFolder scratch(log);
  report.slicer.facts = ask_slicer(report.slicer, scratch.path(), log);

  SupportOptions support = options.support;
  support.output = scratch.path() / "supported.3mf";
  support.parts_for = options.slicer;
  report.supports = support_model(support, log);
  const std::filesystem::path solid = scratch.path() / "solid.stl";
  write_mesh(load_model(support.model, support.load).mesh, solid, MeshFormat::stl);

  const Runs runs(report.slicer, options.settings, scratch.path());
  const std::vector<PartSetting> none =
      profile.own_supports.empty() ? std::vector<PartSetting>{} : profile.no_supports;
  report.forms.push_back(runs.slice_as("none", solid, none, log));
  report.forms.push_back(runs.slice_as(kOurs, support.output, none, log));
  for (const OwnSupports& own : profile.own_supports) {
    if (report.slicer.facts.version.value_or(SlicerVersion{}) < own.from) continue;
    try {
      report.forms.push_back(runs.slice_as(own.name, solid, own.settings, log));
    } catch (const FailureError&) {
      report.failed.push_back(own.name);
    }
  }
  write_bytes(read_text(runs.gcode_of(kOurs)), pending.file());
  end_job(log, report, [&] { pending.file().commit(); });
  return report;
}

}  // namespace aerate
