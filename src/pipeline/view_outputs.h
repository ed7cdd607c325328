#pragma once

#include <filesystem>
#include <optional>

#include "view/picture_request.h"

namespace aerate {

// A picture of a job's result.
struct PictureOutput {
  std::filesystem::path path;  // .png
  PictureRequest request;
};

// What is to be shown of a job, beside its result.
struct ViewOutputs {
  std::optional<PictureOutput> picture;
  std::optional<std::filesystem::path> page;  // .html

  bool are_asked_for() const { return picture || page; }
};

}  // namespace aerate
