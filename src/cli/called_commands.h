#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "cli/option_form.h"
#include "core/mesh.h"
#include "core/monitor.h"
#include "files/load.h"
#include "kernels/sphere.h"

namespace aerate::cli {

// Commands as functions, for programs in other languages: options as on the command line, results as values.

// A command with its options, but for the model.
struct Call {
  std::filesystem::path model;         // its file or, of arrays, what they are called
  const MeshArrays* arrays = nullptr;  // which the caller keeps
  std::vector<std::string> arguments;  // "--wall=1.2"
};

// What a command makes, in millimetres; empty where it makes no such thing.
struct CalledResult {
  std::string report;  // as --json writes it; of `load` what the file was
  std::vector<Sphere> spheres;
  Mesh mesh;  // as it comes out of any file that it is written to
};

struct CalledOption {
  std::string name;  // long, without dashes
  OptionForm form;
  std::string value;  // what its values are called in the help, empty of a flag
  std::string description;
};

struct CalledCommand {
  const char* name;
  // All that a call may have.
  std::vector<CalledOption> (*options)();
  // Without --output nothing is written, and all is checked as if it were. Throws what the command throws.
  CalledResult (*run)(const Call& call, Monitor& monitor);
};

// load (a model as the others read it), inspect, pack and hollow.
std::span<const CalledCommand> called_commands();

CalledCommand called_inspect();
CalledCommand called_pack();
CalledCommand called_hollow();

}  // namespace aerate::cli
