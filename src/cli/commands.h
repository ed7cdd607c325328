#pragma once

#include "core/error.h"

namespace CLI {
class App;
class ParseError;
}  // namespace CLI

namespace aerate::cli {

class ConfigFile;

// The commands of the program. Each adds itself with its options, and is run at the end of parsing if it was
// named; what it throws comes out of the parser.
void add_hollow_command(CLI::App& app, const ConfigFile& config);
void add_pack_command(CLI::App& app, const ConfigFile& config);
void add_inspect_command(CLI::App& app, const ConfigFile& config);
void add_support_command(CLI::App& app, const ConfigFile& config);
void add_slice_command(CLI::App& app, const ConfigFile& config);
void add_hook_command(CLI::App& app, const ConfigFile& config);
void add_batch_command(CLI::App& app, const ConfigFile& config);
void add_studio_command(CLI::App& app, const ConfigFile& config);

// The parser's message as an error of the program's own.
[[noreturn]] void refuse(const CLI::App& app, const CLI::ParseError& error);

// The same error in one line, with its hint, for `hook`: slicers show what a failing script wrote in a dialog.
Error on_one_line(const Error& error);

}  // namespace aerate::cli
