#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/view_outputs.h"

namespace aerate::cli {

// "x", "y=40%", "z=12.5": an axis, and where along it as a share of 0 to 1.
struct PictureCut {
  CutAxis axis = CutAxis::y;
  std::optional<double> share;
};
std::optional<PictureCut> parse_cut(const std::string& text);

// "1000x800", within what can be drawn.
struct PictureSize {
  int width = 0, height = 0;
};
std::optional<PictureSize> parse_picture_size(const std::string& text);

// --picture, --picture-cut, --picture-size, --picture-colour, --view
class ViewOptions {
 public:
  //   what: is shown
  ViewOptions(CLI::App& command, const std::string& what);

  // Throws UsageError for options of a picture without --picture.
  ViewOutputs outputs() const;
  // The files that are written.
  std::vector<std::filesystem::path> files() const;

 private:
  std::string picture_, cut_, size_ = "1000x800", colour_ = "radius", page_;
  std::vector<const CLI::Option*> of_picture_;
};

}  // namespace aerate::cli
