#pragma once

// How far measured figures may be off.

namespace aerate {

// Distances between fp64 balls and fp32 triangles of at most kilometres, mm.
inline constexpr double kLimitError = 1e-7;

// Distances of fp32 vertices from a void's centre computed in fp64, relative to its radius.
inline constexpr double kDistanceError = 1e-9;

// Sums of fp64 terms over millions of triangles, relative to the volume that they add up to.
inline constexpr double kSummationError = 1e-9;

// Vertices on a cut are computed in fp64 and rounded to fp32: a few units in the last place of the largest
// coordinate, and as many as if that were at least 1 mm.
inline constexpr double kRoundingShare = 5e-7;

}  // namespace aerate
