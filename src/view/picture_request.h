#pragma once

#include <optional>

namespace aerate {

// What is asked of a picture.

enum class CutAxis { x, y, z };

enum class PictureColour {
  radius,     // of each void
  thickness,  // what is left between a point of a void's wall and the model's surface
};

inline constexpr int kLeastPictureSide = 160;  // pixels
inline constexpr int kMostPictureSide = 8192;
inline constexpr double kMostPicturePixels = 16e6;  // about 1 GB while it is drawn

struct PictureRequest {
  PictureColour colour = PictureColour::radius;
  std::optional<CutAxis> axis;  // of the cut; any if not given
  std::optional<double>
      share;  // with an axis: where, of the model's extent, 0 to 1; where most void shows if not given
  int width = 1000, height = 800;  // pixels
};

}  // namespace aerate
