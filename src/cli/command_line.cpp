#include "cli/command_line.h"

#include <CLI/CLI.hpp>
#include <exception>
#include <iostream>
#include <new>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cli/commands.h"
#include "cli/config_file.h"
#include "cli/process_options.h"
#include "cli/terminal.h"
#include "core/error.h"
#include "packing/device_choice.h"
#include "pipeline/process_choice.h"

namespace aerate::cli {
namespace {

constexpr const char* kFooter =
    "Lengths are millimetres. Results go to standard output, notices and errors to standard error.\n"
    "A configuration file (--config FILE) holds the same options, by their long names without dashes,\n"
    "in sections named after the commands ([hollow]) or, before any section, for whichever command is run;\n"
    "the command line goes before it.\n"
    "\n"
    "Exit status:\n"
    "    0  done\n"
    "    1  internal failure, or an output that cannot be written (a result that was written, but not its\n"
    "       report, is named)\n"
    "    2  usage: options, a configuration file, limits that contradict each other, more than memory holds\n"
    "    3  unreadable input: missing, empty, truncated or not what it claims to be\n"
    "    4  a mesh that cannot be used: open, flat, without an inside\n"
    "    5  nothing to remove under these limits, or nothing saved by it\n"
    "    6, 7  batch: some models are not done, none is\n"
    "  130  interrupted; no output was written";

std::string version_and_devices() {
  std::string text = "aerate " AERATE_VERSION;
  for (const std::string& device : describe_devices()) text += "\n" + device;
  return text;
}

struct Program {
  Program() {
    app.set_version_flag("--version", version_and_devices);
    app.footer(kFooter);
    app.require_subcommand(1);
    config.emplace(app);
    add_hollow_command(app, *config);
    add_pack_command(app, *config);
    add_inspect_command(app, *config);
    add_support_command(app, *config);
    add_slice_command(app, *config);
    add_hook_command(app, *config);
    add_batch_command(app, *config);
    add_studio_command(app, *config);
  }

  CLI::App app{
      "Packs disjoint spheres inside a printable model, removes them, or the cells round them, as internal\n"
      "voids, and writes a watertight model for any slicer.",
      "aerate"};
  std::optional<ConfigFile> config;  // made after the options that are listed before its own
};

}  // namespace

void visit_program(const std::function<void(const CLI::App&)>& visit) {
  visit(Program().app);
}

void run_command_line(int argc, const char* const* argv) {
  Program program;
  try {
    program.app.parse(argc, argv);
  } catch (const ProcessListRequest&) {
    std::cout << processes_in_words();
  } catch (const CLI::Success& request) {  // --help, --version
    program.app.exit(request);
  } catch (const CLI::ParseError& error) {
    refuse(program.app, error);
  }
  require_stdout_written();
}

int exit_status_of(int argc, char* const* argv) {
  ExitCode code = ExitCode::failure;
  try {
    run_command_line(argc, argv);
    code = ExitCode::done;
  } catch (const Error& error) {
    print_error(error.what(), error.hint());
    code = error.code();
  } catch (const std::bad_alloc&) {
    print_error("out of memory; no output was written",
                "give a larger --max-radius, --min-radius or --tolerance, or a smaller model");
  } catch (const std::exception& error) {
    print_error(error.what(), "this should not happen: please report it with the command line");
  }
  return static_cast<int>(code);
}

}  // namespace aerate::cli
