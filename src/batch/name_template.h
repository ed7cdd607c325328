#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

namespace aerate::batch {

// What stands in the place of {name}, {folder}, {process} and {n}.
struct NameParts {
  std::string name;     // of the model's file, without its ending
  std::string folder;   // the last part of the folder that it is in
  std::string process;  // that prints it
  std::size_t number = 1;
};

// The result's name, below the folder of results. Throws UsageError for another word in braces, and for a name that leads out of that folder
// or is none.
std::filesystem::path name_from(const std::string& pattern, const NameParts& parts);

// A name that was given for one model: relative, and not leading out. Throws UsageError.
std::filesystem::path require_inside(const std::filesystem::path& name);

}  // namespace aerate::batch
