#include "pipeline/solid_file.h"

#include <fmt/format.h>
#include <utility>

#include "core/error.h"
#include "files/three_mf.h"
#include "printing/slicers/slicers.h"

namespace aerate {

SolidFormat solid_format_of(const HollowOptions& options) {
  SolidFormat format{&format_to_write(options.output), options.modifiers, options.object_name};
  if (format.modifiers && format.mesh != &MeshFormat::three_mf) {
    throw UsageError(fmt::format("{}: modifiers need a 3MF file", options.output.string()),
                     "give a name that ends in .3mf, or leave out --as modifiers");
  }
  return format;
}

void write_named(const Mesh& mesh, const Destination& destination, const ObjectName& object) {
  const ObjectPart whole{"model", 0, mesh.triangles.size(), false, ""};
  write_bytes(to_3mf(mesh, object.slicer->modifiers->named(whole, object.name)), destination);
}

void write_solid(const Solid& solid, const PendingFile& file, const SolidFormat& format) {
  if (!format.modifiers) {
    if (format.object_name && format.mesh == &MeshFormat::three_mf) {
      write_named(solid.mesh, file, *format.object_name);
    } else {
      write_mesh(solid.mesh, file, *format.mesh);
    }
    return;
  }
  const std::vector<ObjectPart> parts = modifier_parts(solid, format.modifiers->infill_percent);
  const ThreeMfExtras extras = format.modifiers->slicer->modifiers->extras(
      parts.front(), parts.back(), format.object_name ? format.object_name->name : "");
  write_bytes(to_3mf(with_void_shells_turned(solid.mesh, solid), extras), file);
}

Mesh read_back_solid(const Solid& solid, const std::filesystem::path& path, const SolidFormat& format,
                     Monitor& monitor) {
  Mesh mesh = read_back(path, *format.mesh, monitor);
  if (!format.modifiers) return mesh;
  if (mesh.triangles.size() != solid.mesh.triangles.size() ||
      format.modifiers->slicer->modifiers->read(path) !=
          modifier_parts(solid, format.modifiers->infill_percent)) {
    throw FailureError(
        "the result failed its check, so it was not kept: its parts are not the model and its voids",
        "please report this with the model and the options");
  }
  return with_void_shells_turned(std::move(mesh), solid);
}

void write_beside(const Solid& solid, AnnouncedFile& pending, const SolidFormat& format,
                  const std::function<void(const Mesh& written)>& check, Monitor& monitor) {
  monitor.stage("write");
  write_solid(solid, pending.file(), format);
  monitor.check_interrupted();
  monitor.stage("check");
  check(read_back_solid(solid, pending.file().path(), format, monitor));
  monitor.check_interrupted();
}

void write_checked(const Solid& solid, AnnouncedFile& pending, const SolidFormat& format,
                   const std::function<void(const Mesh& written)>& check, Monitor& monitor) {
  write_beside(solid, pending, format, check, monitor);
  pending.file().commit();
}

}  // namespace aerate
