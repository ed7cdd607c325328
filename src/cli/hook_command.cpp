#include <CLI/CLI.hpp>
#include <algorithm>
#include <exception>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <iostream>
#include <memory>
#include <new>
#include <optional>
#include <string>
#include <system_error>
#include <unistd.h>

#include "cli/commands.h"
#include "cli/form_options.h"
#include "cli/model_options.h"
#include "cli/run_reported.h"
#include "cli/terminal.h"
#include "core/error.h"
#include "core/listed.h"
#include "pipeline/hook.h"
#include "printing/slicers/text_file.h"

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

// The window and the settings of a slicer end a line at a semicolon, and at what ends any line.
void require_pastable(const std::string& path) {
  const auto breaks_line = [](unsigned char c) { return c < 0x20 || c == 0x7f || c == ';'; };
  if (!std::ranges::any_of(path, breaks_line)) return;
  throw UsageError(path +
                       ": a name with a semicolon or a control character cannot stand in the slicer's "
                       "settings",
                   "rename it or its folder");
}

std::string own_path() {
  std::error_code error;
  const std::filesystem::path path = std::filesystem::read_symlink("/proc/self/exe", error);
  return error ? std::string("aerate") : path.string();
}

// What was just thrown.
Error caught_on_one_line() {
  try {
    throw;
  } catch (const Error& error) {
    return on_one_line(error);
  } catch (const std::bad_alloc&) {
    return FailureError("out of memory; the G-code is as it was");
  } catch (const std::exception& error) {
    return on_one_line(FailureError(error.what(), "this should not happen: please report it"));
  }
}

struct HookCommand {
  HookCommand(CLI::App& command, const ConfigFile& config)
      : model(command, "--model",
              "The model on the plate, STL or any other that is read, or the project as 3MF; without it the "
              "G-code is only annotated"),
        form(command, config),
        run_options(command) {
    command
        .add_option(
            "--model-folder", model_folder,
            "Where the model is looked for without --model: by the name of the object, which is in the "
            "G-code if the slicer labels objects, else by that of the output")
        ->excludes(command.get_option("--model"))
        ->type_name("FOLDER");
    command.add_flag(
        "--strict", is_strict,
        "Exit with an error where the print has to stay as it is; without it the reason becomes a comment "
        "in the G-code, since slicers write none if a script fails");
    command.add_flag(
        "--name-saving", names_saving,
        "Put what was saved into the name that the slicer's window gives the print (PrusaSlicer)");
    command.add_option("--log", log, "Add the report to the end of this file")->type_name("FILE");
    command.add_option("FILE", gcode, "The G-code; slicers append it to the script's line")->type_name("");
    command
        .add_option("--print-setup", setup,
                    "Print the line to paste into a slicer's post-processing scripts: " +
                        listed(of_slicers(&SlicerProfile::calls_hook), "or") +
                        " (both untested; the latter for annotation only)")
        ->check(CLI::IsMember(of_slicers(&SlicerProfile::calls_hook)))
        ->type_name("SLICER");
  }

  std::string setup_line() const {
    const std::string program = own_path();
    require_pastable(program);
    std::string line = quoted(program) + " hook";
    const auto calls = [&](const SlicerProfile& slicer) {
      return std::ranges::count(slicer.calls_hook, setup) > 0;
    };
    // One that cannot slice again takes no model.
    if (!std::ranges::find_if(slicers(), calls)->repeats_gcode) return line;
    const std::string file = model.path.empty() ? std::string("/path/to/model.stl")
                                                : std::filesystem::absolute(model.path).string();
    require_pastable(file);
    return line + " --model " + quoted(file);
  }

  void run() const {
    if (!setup.empty()) {
      std::cout << setup_line() << '\n';
      return;
    }
    if (gcode.empty()) throw UsageError("FILE is required", "see 'aerate hook --help'");
    HookOptions options;
    options.gcode = gcode;
    try {
      options.request = form.request(model);
    } catch (const Error& error) {
      options.refused = error;
    }
    options.model_folder = model_folder;
    options.is_strict = is_strict;
    options.names_saving = names_saving;
    std::error_code unknown;
    const bool is_there = std::filesystem::is_regular_file(options.gcode, unknown);
    try {
      run_logged(options);
    } catch (...) {
      const Error error = caught_on_one_line();
      if (is_strict || !is_there || error.code() == ExitCode::interrupted) throw;
      leave_print(error.what());
    }
  }

 private:
  // What it is that goes wrong, the print is there, and the slicer has to be told that it may take it.
  void leave_print(const std::string& why) const {
    const std::string line = fmt::format("the print stays as it is: {}", why);
    print_note(line);
    if (!log.empty()) append_to_log(line + '\n');
  }

  void append_to_log(const std::string& text) const {
    std::ofstream file(log, std::ios::app | std::ios::binary);
    file << text << std::flush;
    if (!file) print_note(fmt::format("{}: the log cannot be written", log));
  }

  void run_logged(const HookOptions& options) const {
    std::optional<HookReport> done;
    const JobFiles files{form.inputs(model), {options.gcode}};
    // A slicer that shows what a script says should show what matters.
    const Verbosity verbosity = isatty(STDERR_FILENO) != 0 ? run_options.verbosity() : Verbosity::quiet;
    const auto run = [&](Monitor& monitor) {
      done = run_hook(options, monitor);
      return *done;
    };
    run_reported(run_options, files, run, verbosity);
    if (done && done->is_refused)
      print_note(fmt::format("the print stays as it is: {}", aerate::on_one_line(done->remark)));
    if (done && !log.empty()) append_to_log(to_text(*done));
  }

  ModelOptions model;
  FormOptions form;
  RunOptions run_options;
  std::string gcode;
  std::string setup;
  std::string model_folder;
  std::string log;
  bool is_strict = false;
  bool names_saving = false;
};

void run_for_slicer(const HookCommand& hook) {
  try {
    hook.run();
  } catch (...) {
    throw caught_on_one_line();
  }
}

}  // namespace

// Of several lines the first says what failed, and the last of what a program printed mostly why.
Error on_one_line(const Error& error) {
  std::string text = error.what();
  while (text.ends_with('\n')) text.pop_back();
  const std::size_t first_end = text.find('\n');
  if (first_end != std::string::npos)
    text = text.substr(0, first_end) + " ... " + text.substr(text.rfind('\n') + 1);
  if (!error.hint().empty()) text += "; " + error.hint();
  return {error.code(), text};
}

void add_hook_command(CLI::App& app, const ConfigFile& config) {
  CLI::App& command =
      *app.add_subcommand("hook", "Post-process a slicer's G-code: hollow, slice again, replace it");
  command.callback([job = std::make_shared<HookCommand>(command, config)] { run_for_slicer(*job); });
}

}  // namespace aerate::cli
