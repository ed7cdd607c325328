#include "pipeline/solid_file.h"

#include <fmt/format.h>
#include <string>
#include <utility>
#include <vector>

#include "core/error.h"
#include "files/text_scan.h"
#include "printing/slicers/slicers.h"

namespace aerate {

namespace {

// What the file is to hold beside the model.
std::vector<ObjectPart> parts_of(const Solid& solid, const ModifierOptions& modifiers) {
  return modifier_parts(solid, modifiers.infill_percent, modifiers.hold_lightning ? kLightning : "");
}

void require_ending(const std::filesystem::path& path, const ModifierFormat& format) {
  if (ending_of(path) == format.ending) return;
  throw UsageError(format.ending == ".3mf" ? path.string() + ": modifiers need a 3MF file"
                                           : fmt::format("{}: modifiers of flavor {} need an AMF file",
                                                         path.string(), format.flavor),
                   fmt::format("give a name that ends in {}, or leave out --as modifiers", format.ending));
}

}  // namespace

SolidFormat solid_format_of(const HollowOptions& options) {
  if (!options.modifiers) return {&format_to_write(options.output), std::nullopt, options.object_name};
  require_ending(options.output, *options.modifiers->slicer->modifiers);
  return {&MeshFormat::three_mf, options.modifiers, options.object_name};
}

void write_named(const Mesh& mesh, const Destination& destination, const ObjectName& object) {
  const ObjectPart whole{"model", 0, mesh.triangles.size(), false, ""};
  write_bytes(object.slicer->modifiers->named(mesh, whole, object.name), destination);
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
  const std::vector<ObjectPart> parts = parts_of(solid, *format.modifiers);
  write_bytes(format.modifiers->slicer->modifiers->file(with_void_shells_turned(solid.mesh, solid),
                                                        parts.front(), parts.back(),
                                                        format.object_name ? format.object_name->name : ""),
              file);
}

Mesh read_back_solid(const Solid& solid, const std::filesystem::path& path, const SolidFormat& format,
                     Monitor& monitor) {
  if (!format.modifiers) return read_back(path, *format.mesh, monitor);
  const ModifierFormat& modifiers = *format.modifiers->slicer->modifiers;
  Mesh mesh =
      modifiers.read_mesh != nullptr ? modifiers.read_mesh(path) : read_back(path, *format.mesh, monitor);
  if (mesh.triangles.size() != solid.mesh.triangles.size() ||
      modifiers.read(path) != parts_of(solid, *format.modifiers)) {
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
