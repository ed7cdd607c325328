#include "cli/hook_command.h"

#include <CLI/CLI.hpp>
#include <filesystem>
#include <iostream>
#include <string>
#include <system_error>

#include "cli/form_options.h"
#include "cli/model_options.h"
#include "cli/report_output.h"
#include "cli/slice_report.h"
#include "cli/terminal.h"
#include "core/error.h"
#include "pipeline/hook.h"
#include "pipeline/thread_limit.h"

namespace aerate::cli {
namespace {

// For the shell that PrusaSlicer and its relatives hand a script's line to.
std::string quoted(const std::string& text) {
  constexpr const char* kPlain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789/._-+,:=@%";
  if (!text.empty() && text.find_first_not_of(kPlain) == std::string::npos) return text;
  std::string result = "'";
  for (const char c : text) result += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return result + "'";
}

std::string own_path() {
  std::error_code error;
  const std::filesystem::path path = std::filesystem::read_symlink("/proc/self/exe", error);
  return error ? std::string("aerate") : path.string();
}

}  // namespace

struct HookCommand::Options {
  Options(CLI::App& app, const ConfigFile& config)
      : command(
            *app.add_subcommand("hook", "Post-process a slicer's G-code: hollow, slice again, replace it")),
        model(command, "--model",
              "The model on the plate, STL or any other that is read, or the project as 3MF; without it the "
              "G-code is only annotated"),
        form(command, config),
        run(command) {
    command.add_option("FILE", gcode, "The G-code; slicers append it to the script's line")->type_name("");
    command
        .add_option("--print-setup", setup,
                    "Print the line to paste into a slicer's post-processing scripts: prusa-slicer, "
                    "super-slicer or orca-slicer (both untested; the latter for annotation only)")
        ->check(CLI::IsMember({"prusa-slicer", "super-slicer", "orca-slicer"}))
        ->type_name("SLICER");
  }

  std::string setup_line() const {
    std::string line = quoted(own_path()) + " hook";
    // Re-slicing from the settings in a G-code is not possible with OrcaSlicer's command line.
    if (setup == "orca-slicer") return line;
    const std::string file = model.path.empty() ? std::string("/path/to/model.stl")
                                                : std::filesystem::absolute(model.path).string();
    return line + " --model " + quoted(file);
  }

  CLI::App& command;
  ModelOptions model;
  FormOptions form;
  RunOptions run;
  std::string gcode;
  std::string setup;
};

HookCommand::HookCommand(CLI::App& app, const ConfigFile& config)
    : options_(std::make_unique<Options>(app, config)) {}
HookCommand::~HookCommand() = default;

bool HookCommand::chosen() const {
  return options_->command.parsed();
}

// Of several lines the first says what failed, and the last of what a program printed mostly why.
Error HookCommand::on_one_line(const Error& error) {
  std::string text = error.what();
  while (text.ends_with('\n')) text.pop_back();
  const std::size_t first_end = text.find('\n');
  if (first_end != std::string::npos)
    text = text.substr(0, first_end) + " ... " + text.substr(text.rfind('\n') + 1);
  if (!error.hint().empty()) text += "; " + error.hint();
  return {error.code(), text};
}

void HookCommand::run(InterruptGuard& interrupt) const {
  if (!options_->setup.empty()) {
    std::cout << options_->setup_line() << '\n';
    return;
  }
  if (options_->gcode.empty()) throw UsageError("FILE is required", "see 'aerate hook --help'");
  HookOptions options;
  options.gcode = options_->gcode;
  options.slicer_path = options_->form.slicer_path;
  options.form = options_->form.choice();
  options.modifier_infill_percent = options_->form.modifier_infill_percent;
  options.hollow = options_->form.hollow(options_->model);

  // Slicers show what a script writes to standard error as an error: notices go into the report alone.
  TerminalMonitor monitor(interrupt, Verbosity::quiet);
  ReportOutput output(options_->run, {options.gcode, options.hollow.model}, monitor);
  HookReport report;
  run_with_threads(options_->run.threads, [&] { report = run_hook(options, monitor); });
  output.write([&] { return to_text(report); }, [&] { return to_json(report); });
}

}  // namespace aerate::cli
