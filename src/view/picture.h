#pragma once

#include "core/monitor.h"
#include "kernels/vec.h"
#include "view/camera.h"
#include "view/image.h"
#include "view/picture_request.h"
#include "view/scene.h"

// A scene as a picture: the model cut open and lit, what is solid in the plane of the cut hatched, void walls coloured, marks
// at their places, and figures below.

namespace aerate {

// Where things are on a picture.
class PictureFrame {
 public:
  // `middle`: of what is to be seen, in view coordinates; `room`: the middle of its place on the picture
  PictureFrame(const Camera& camera, ViewPoint middle, PixelPoint room, double pixels_per_mm)
      : camera_(camera), view_(middle), room_(room), scale_(pixels_per_mm) {}

  double pixels_per_mm() const { return scale_; }
  const Camera& camera() const { return camera_; }
  PixelPoint pixel_of(Vec3d place) const { return on_picture(camera_.to_view(place)); }
  PixelPoint on_picture(Vec3d view) const {
    return {room_.x + (view.x - view_.x) * scale_, room_.y - (view.y - view_.y) * scale_};
  }
  // In view coordinates, mm.
  ViewPoint in_view(PixelPoint pixel) const {
    return {view_.x + (pixel.x - room_.x) / scale_, view_.y - (pixel.y - room_.y) / scale_};
  }

 private:
  Camera camera_;
  ViewPoint view_;
  PixelPoint room_;
  double scale_;
};

struct Picture {
  Image image;
  PictureFrame frame;
  Cut cut;
};

// The same bytes for any number of threads. Throws InterruptedError.
Picture draw_picture(const Scene& scene, const PictureRequest& request, Monitor& monitor);

// What the picture is drawn in.
namespace picture_colours {
inline constexpr Colour kPaper{255, 255, 255};
inline constexpr Colour kSolid{250, 246, 238}, kHatch{120, 104, 84}, kOverlap{150, 30, 30};
inline constexpr Colour kOuter{196, 204, 214}, kInside{214, 150, 110};
inline constexpr Colour kChannel{204, 121, 167}, kHole{213, 94, 0};
inline constexpr Colour kInk{20, 20, 20}, kFaint{110, 110, 110};
}  // namespace picture_colours

// From dark violet over green to yellow, evenly light for those who see few colours too (viridis). `share`: 0 to 1.
Colour scale_colour(double share);

}  // namespace aerate
