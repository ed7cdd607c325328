#pragma once

#include <array>
#include <filesystem>
#include <string>

#include "core/mesh.h"
#include "core/monitor.h"
#include "files/output_file.h"

namespace aerate {

struct InputFile;
struct LoadedModel;
struct LoadOptions;
class OwnFile;

// One row for each mesh file format, defined in the room of that format. Everything else loops over the rows.
struct MeshFormat {
  const char* name;    // "STL"
  const char* ending;  // ".stl"

  // A whole file as a model, of which load_model() sets `format`. Looks at everything that memory is taken
  // for before it is taken, may change the bytes, and throws InputError saying what is wrong and where.
  LoadedModel (*read)(InputFile& file, const LoadOptions& options);

  // The bytes depend on the mesh alone. Null, as the one below, for a format that is only read.
  void (*write)(const Mesh& mesh, OutputFile& file) = nullptr;

  // What `write` wrote, and nothing else: see read_back().
  Mesh (*read_back)(OwnFile& file) = nullptr;

  static const MeshFormat stl, three_mf, obj, ply, off, glb, gltf, three_ds;
};

// In the order in which they are listed.
inline constexpr std::array kMeshFormats{&MeshFormat::stl,  &MeshFormat::three_mf, &MeshFormat::obj,
                                         &MeshFormat::ply,  &MeshFormat::off,      &MeshFormat::glb,
                                         &MeshFormat::gltf, &MeshFormat::three_ds};

// For sentences: "STL, 3MF, ... or 3DS", ".stl, .3mf, .obj or .ply".
std::string names_that_are_read();
std::string endings_that_are_written();

// Whether a file name ends (in any case) as those of a format do.
bool is_a_models_name(const std::filesystem::path& path);

// From the file name's ending (any case). Throws InputError for one that cannot be read, UsageError for one
// that cannot be written.
const MeshFormat& format_to_read(const std::filesystem::path& path);
const MeshFormat& format_to_write(const std::filesystem::path& path);

// The same; null where format_to_write throws.
const MeshFormat* find_format_to_write(const std::filesystem::path& path);

// Throws FailureError with the system's reason (disk full, ...).
void write_mesh(const Mesh& mesh, const Destination& destination, const MeshFormat& format);

// A mesh that `write_mesh` wrote, read from its file: triangles in the order of the file, vertices welded and
// numbered in order of first use, coordinates to the last bit. A block at a time: assimp would hold several
// times the size of the file, and rounds decimals. (3MF is read as any model is.)
// Throws FailureError (3MF: InputError) for a file that is not as it was written; InterruptedError.
Mesh read_back(const std::filesystem::path& path, const MeshFormat& format, Monitor& monitor);

}  // namespace aerate
