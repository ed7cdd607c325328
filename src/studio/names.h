#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace aerate::studio {

// What a file is called in the studio: without folders (of either slash), short, in UTF-8 without control characters. It is shown,
// and never a path.
std::string shown_name(std::string_view sent);

// The ending of a name in lower case with its dot, if it is one of a model that can be read. Throws InputError in the words of the
// command line.
std::string ending_of_model(const std::string& name);

// "bunny.stl", ".stl" -> "bunny-hollow.stl"
std::string name_of_result(const std::string& model_name, std::string_view ending);

// A value of the header Content-Disposition, for a file to be saved under this name.
std::string attachment_called(const std::string& name);

// What files are called in the private folder: as nobody calls a model, so that they are told from other words.
inline constexpr const char* kModelStem = "aerate-studio-model";
inline constexpr const char* kResultStem = "aerate-studio-result";

// Texts of the pipeline name the files that it was given. These are what the user calls them.
class ShownPaths {
 public:
  // With or without its folder; no other file may have this name.
  void add(const std::filesystem::path& path, const std::string& name) {
    names_.emplace_back(path.string(), name);
    names_.emplace_back(path.filename().string(), name);
  }
  std::string in(std::string text) const;

 private:
  std::vector<std::pair<std::string, std::string>> names_;
};

}  // namespace aerate::studio
