#include <CLI/CLI.hpp>
#include <algorithm>
#include <exception>
#include <filesystem>
#include <iostream>
#include <memory>
#include <new>
#include <string>
#include <system_error>

#include "cli/commands.h"
#include "cli/form_options.h"
#include "cli/model_options.h"
#include "cli/run_reported.h"
#include "core/error.h"
#include "core/listed.h"
#include "pipeline/hook.h"

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

struct HookCommand {
  HookCommand(CLI::App& command, const ConfigFile& config)
      : model(command, "--model",
              "The model on the plate, STL or any other that is read, or the project as 3MF; without it the "
              "G-code is only annotated"),
        form(command, config),
        run_options(command) {
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
    options.request = form.request(model);
    // Slicers show what a script writes to standard error as an error: notices go into the report alone.
    JobFiles files{form.inputs(model), {options.gcode}};
    run_reported(
        run_options, files, [&](Monitor& monitor) { return run_hook(options, monitor); }, Verbosity::quiet);
  }

  ModelOptions model;
  FormOptions form;
  RunOptions run_options;
  std::string gcode;
  std::string setup;
};

void run_for_slicer(const HookCommand& hook) {
  try {
    hook.run();
  } catch (const Error& error) {
    throw on_one_line(error);
  } catch (const std::bad_alloc&) {
    throw FailureError("out of memory; the G-code is as it was");
  } catch (const std::exception& error) {
    throw on_one_line(FailureError(error.what(), "this should not happen: please report it"));
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
