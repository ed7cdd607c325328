#include "pipeline/solid_file.h"

#include <fmt/format.h>
#include <string>
#include <utility>
#include <vector>

#include "check/same_triangles.h"
#include "core/error.h"
#include "files/text_scan.h"
#include "files/weld.h"
#include "printing/slicers/slicers.h"
#include "printing/slicers/support_blockers.h"

namespace aerate {

namespace {

// What the file is to hold beside the model.
std::vector<ObjectPart> parts_of(const Solid& solid, const ModifierOptions& modifiers) {
  return modifier_parts(solid, modifiers.infill_percent, modifiers.hold_lightning ? kLightning : "");
}

//   what: is to be written; option: asks for it
void require_ending(const std::filesystem::path& path, const ModifierFormat& format, const char* what,
                    const char* option) {
  if (ending_of(path) == format.ending) return;
  throw UsageError(format.ending == ".3mf" ? fmt::format("{}: {} need a 3MF file", path.string(), what)
                                           : fmt::format("{}: {} of flavor {} need an AMF file",
                                                         path.string(), what, format.flavor),
                   fmt::format("give a name that ends in {}, or leave out {}", format.ending, option));
}

// The mesh of a file with support blockers, without these. Throws FailureError if they are not those of the solid.
Mesh without_blockers(Mesh mesh, const Solid& solid, const BlockerFormat& format, Monitor& monitor) {
  require_same_triangles(mesh, with_support_blockers(solid, format.growth), monitor);
  mesh.triangles.resize(solid.mesh.triangles.size());
  drop_unused_vertices(mesh);
  return mesh;
}

[[noreturn]] void fail_by_parts(const char* parts) {
  throw FailureError(
      fmt::format("the result failed its check, so it was not kept: its parts are not the model and {}",
                  parts),
      "please report this with the model and the options");
}

}  // namespace

SolidFormat solid_format_of(const HollowOptions& options) {
  const bool needs_file = options.modifiers || options.support_blockers != nullptr;
  if (options.output.empty() && needs_file)
    throw UsageError(fmt::format("{} are parts of a file, and none is to be written",
                                 options.modifiers ? "modifiers" : "support blockers"),
                     "name the output");
  if (options.output.empty()) return {};
  if (options.modifiers) {
    require_ending(options.output, *options.modifiers->slicer->modifiers, "modifiers", "--as modifiers");
    return {&MeshFormat::three_mf, options.modifiers, std::nullopt, options.object_name};
  }
  if (options.support_blockers != nullptr) {
    require_ending(options.output, *options.support_blockers->modifiers, "support blockers",
                   "--support-blockers");
    const BlockerFormat blockers{options.support_blockers, growth_of_blockers(options.packing.limits().wall)};
    return {&MeshFormat::three_mf, std::nullopt, blockers, options.object_name};
  }
  return {&format_to_write(options.output), std::nullopt, std::nullopt, options.object_name};
}

std::size_t triangles_written(const Solid& solid, const HollowOptions& options) {
  const std::size_t count = solid.mesh.triangles.size();
  return options.support_blockers == nullptr ? count : 2 * count - solid.outer_triangle_count();
}

void write_named(const Mesh& mesh, const Destination& destination, const ObjectName& object) {
  const ObjectPart whole{"model", 0, mesh.triangles.size(), false, ""};
  write_bytes(object.slicer->modifiers->named(mesh, whole, object.name), destination);
}

void write_solid(const Solid& solid, const PendingFile& file, const SolidFormat& format) {
  const std::string object_name = format.object_name ? format.object_name->name : "";
  if (format.blockers) {
    const std::vector<ObjectPart> parts = blocker_parts(solid);
    write_bytes(
        format.blockers->slicer->modifiers->file(with_support_blockers(solid, format.blockers->growth),
                                                 parts.front(), parts.back(), object_name),
        file);
    return;
  }
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
                                                        parts.front(), parts.back(), object_name),
              file);
}

Mesh read_back_solid(const Solid& solid, const std::filesystem::path& path, const SolidFormat& format,
                     Monitor& monitor) {
  if (format.blockers) {
    if (format.blockers->slicer->modifiers->read(path) != blocker_parts(solid))
      fail_by_parts("its support blockers");
    return without_blockers(read_back(path, *format.mesh, monitor), solid, *format.blockers, monitor);
  }
  if (!format.modifiers) return read_back(path, *format.mesh, monitor);
  const ModifierFormat& modifiers = *format.modifiers->slicer->modifiers;
  Mesh mesh =
      modifiers.read_mesh != nullptr ? modifiers.read_mesh(path) : read_back(path, *format.mesh, monitor);
  if (mesh.triangles.size() != solid.mesh.triangles.size() ||
      modifiers.read(path) != parts_of(solid, *format.modifiers))
    fail_by_parts("its voids");
  return with_void_shells_turned(std::move(mesh), solid);
}

void write_beside(const Solid& solid, AnnouncedFile* pending, const SolidFormat& format,
                  const std::function<void(const Mesh& written)>& check, Monitor& monitor) {
  if (pending != nullptr) {
    monitor.stage("write");
    write_solid(solid, pending->file(), format);
    monitor.check_interrupted();
  }
  monitor.stage("check");
  check(pending != nullptr ? read_back_solid(solid, pending->file().path(), format, monitor)
                           : as_read_back(solid.mesh));
  monitor.check_interrupted();
}

}  // namespace aerate
