#pragma once

namespace aerate {

// Of supports without their teeth.
struct BodyShape {
  double clearance = 0.8;     // between the body and the model, mm
  double tooth_height = 1.2;  // between the body and the ceilings that its teeth reach to, mm
  double foot = 2;            // half the width that it is not drawn in below, and its foot, mm
  double margin = 1.05;       // round what it carries, at its top, mm
  double least_voxel =
      0.45;  // no finer voxels than this are of use, mm; in finer ones more voids find a place
  bool stands_alone = true;  // else its teeth and the plate hold it, and it need not be wide enough to stand
};

}  // namespace aerate
