#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/mesh.h"
#include "core/solid.h"
#include "kernels/vec.h"

// What there is to see of a job, for pictures and pages: a value that knows neither options nor reports. Millimetres.

namespace aerate {

// What the voids of a scene are.
enum class VoidUse {
  removed,    // taken out of the model
  modifiers,  // volumes of another infill in a model that stays solid
  packed,     // planned: a packing that was not taken out
  found,      // hollows of a model as it was read
};

// A void, as a part of the mesh. Those of a scene follow each other as its parts of that kind do.
struct SceneVoid {
  std::size_t number = 1;  // in the result, from 1
  Vec3d place{0, 0, 0};    // its centre: of its sphere, else of its volume
  double radius = 0;       // of its sphere, or of the sphere whose cell it is; else of a ball of its volume
  double volume = 0;       // of its sphere with its roof, or of the cell; mm3
  std::optional<double> wall;  // between it and the model's surface
};

enum class MarkKind {
  ceiling,        // wider than is bridged
  thinnest_wall,  // of the whole result
  cup,            // what a layer closes in, at the middle of its opening
  hole_in_mesh,   // open edges; the lines are its rim
  bad_edges,      // shared by more than two triangles, or by some that face opposite ways; the lines are they
  crossing,       // triangles that intersect each other
};

// The last three are what is wrong with a model as it was read.
inline bool is_defect(MarkKind kind) {
  return kind >= MarkKind::hole_in_mesh;
}

struct SceneMark {
  MarkKind kind = MarkKind::crossing;
  Vec3d place{0, 0, 0};
  std::string text;  // one line, in the words of the report: "a hole of 3.2 mm, 17 edges"
  std::vector<std::pair<Vec3d, Vec3d>> lines = {};
};

// A figure of the report.
struct SceneFigure {
  std::string name, value;
};

// A figure of the model as it was and as it is.
struct SceneChange {
  std::string name, unit;
  double before = 0;
  double after = 0;
};

struct Scene {
  std::string title;  // the model's file, without its folder
  std::string is;     // what is shown, in a few words: "hollowed by 61 voids"
  // All triangles. Parts follow each other from the first to the last as those of a Solid do; what is outside faces outward,
  // voids, channels and holes into what they bound. Modifiers and planned spheres are voids of it. A model that was only read
  // has its own triangles, those of sealed hollows as voids at the end.
  Mesh mesh;
  std::vector<SolidPart> parts;
  // Whether winding numbers say what is solid. Else there is a surface and nothing more.
  bool is_closed = true;
  VoidUse void_use = VoidUse::removed;
  bool has_spheres = false;  // voids are spheres with the roofs that they take
  std::vector<SceneVoid> voids;
  std::vector<SceneMark> marks;
  std::vector<SceneFigure> figures;
  std::vector<SceneFigure> details;  // further ones, for where there is room
  std::vector<SceneChange> changes;

  Vec3d up{0, 0, 1};                   // unit, against gravity while it is printed
  std::optional<double> layer_height;  // as far as the print was described
  double tolerance = 0;                // of void surfaces: how far they stay inside their shapes
  std::optional<double> bridge;        // widest ceiling that needs no support, where ceilings are limited
};

// Parts of one kind, which follow each other.
std::vector<SolidPart> parts_of(const Scene& scene, PartKind kind);

}  // namespace aerate
