#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>

#include "core/mesh.h"
#include "core/monitor.h"
#include "core/solid.h"
#include "files/formats.h"
#include "pipeline/announced_file.h"
#include "pipeline/options.h"

namespace aerate {

// Support blockers of a slicer that has such, larger than their voids by so many mm.
struct BlockerFormat {
  const SlicerProfile* slicer = nullptr;
  double growth = 0;
};

// How a solid is put into a file: its voids as inward shells, with support blockers or without, or, in a slicer's own kind of
// file, as modifiers.
struct SolidFormat {
  const MeshFormat* mesh = &MeshFormat::stl;  // without modifiers
  std::optional<ModifierOptions> modifiers;
  std::optional<BlockerFormat> blockers;
  std::optional<ObjectName> object_name;
};

// Throws UsageError for an ending that cannot be written, and for modifiers and support blockers in anything but the file that
// their slicer reads.
SolidFormat solid_format_of(const HollowOptions& options);

// Triangles of the file that is made of a solid.
std::size_t triangles_written(const Solid& solid, const HollowOptions& options);

// A 3MF of one body, of a slicer that has such, called by this name. Throws FailureError with the system's reason.
void write_named(const Mesh& mesh, const Destination& destination, const ObjectName& object);

// Throws FailureError with the system's reason.
void write_solid(const Solid& solid, const PendingFile& file, const SolidFormat& format);

// The mesh that `write_solid` wrote, read from its file (see formats.h), with voids as inward shells again
// and without support blockers.
// Throws what read_back() throws, and FailureError if the parts of the file, blockers among them, are not those of the solid.
Mesh read_back_solid(const Solid& solid, const std::filesystem::path& path, const SolidFormat& format,
                     Monitor& monitor);

// Writes a solid beside its target, reads it back and lets `check` look at it. Nothing becomes the target yet: what `check`
// throws leaves that as it was. Without a file, `check` looks at what would have been read.
void write_beside(const Solid& solid, AnnouncedFile* pending, const SolidFormat& format,
                  const std::function<void(const Mesh& written)>& check, Monitor& monitor);

}  // namespace aerate
