#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "cli/called_commands.h"
#include "core/drainage.h"
#include "core/mesh.h"
#include "core/monitor.h"
#include "pipeline/best_form.h"

namespace CLI {
class Option;
}

namespace aerate::cli {

// Every option of 'aerate hollow'.
void visit_hollow_options(const std::function<void(const CLI::Option&)>& visit);

// What 'aerate hollow' would do with this model and these arguments. Throws UsageError as it does.
//   stem: of the result, which gets the ending that the options ask for, .stl if they ask for none
std::vector<JobForm> forms_of_hollow(const std::filesystem::path& model, const std::filesystem::path& stem,
                                     std::vector<std::string> arguments);

// What it makes of arrays, with escape holes only where they may open. Throws what it throws.
Mesh hollow_mesh(const Call& call, const std::function<bool(const Tube& hole)>& may_open, Monitor& monitor);

}  // namespace aerate::cli
