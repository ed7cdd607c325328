#pragma once

#include <filesystem>
#include <string_view>

#include "core/mesh.h"

namespace aerate {

enum class MeshFormat { stl, obj, ply, three_mf };

// From the file name's ending (any case). Throws UsageError for one that cannot be written.
MeshFormat mesh_format_of(const std::filesystem::path& path);

// A file being written beside its target, under a temporary name in the same folder that ends like the
// target's. It becomes the target only by `commit`; otherwise the destructor removes it. A target that is a
// symbolic link is followed. Throws FailureError if it cannot be created, or if the target is a directory or
// anything else that a file must not replace.
class PendingFile {
 public:
  explicit PendingFile(std::filesystem::path target);
  ~PendingFile();
  PendingFile(const PendingFile&) = delete;
  PendingFile& operator=(const PendingFile&) = delete;

  const std::filesystem::path& path() const { return path_; }      // where to write
  const std::filesystem::path& target() const { return target_; }  // what the user asked for
  void commit();  // flushes to disk and renames onto the target, atomically

 private:
  std::filesystem::path target_, path_;
  bool committed_ = false;
};

// Writes binary STL (true unit facet normals; (0, 0, 1) for a triangle without area, since some slicers
// refuse zero normals), OBJ (decimals that read back to the same fp32, also where a reader rounds more than
// once), binary little-endian PLY or 3MF (see three_mf.h). The bytes depend on the mesh alone. Throws
// FailureError with the system's reason (disk full, ...); for a pending file its message names the target.
void write_mesh(const Mesh& mesh, const std::filesystem::path& path, MeshFormat format);
void write_mesh(const Mesh& mesh, const PendingFile& file, MeshFormat format);

// Fills a file with bytes that were made elsewhere. Throws as `write_mesh` does.
void write_bytes(std::string_view bytes, const std::filesystem::path& path);
void write_bytes(std::string_view bytes, const PendingFile& file);

}  // namespace aerate
