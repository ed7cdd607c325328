#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "files/input_file.h"
#include "files/load.h"

struct zip;

namespace aerate {

// A volume that a slicer's project says not to be part of the model.
struct OtherVolume {
  std::string kind, name;
  bool is_modifier = false;
  bool is_own = false;       // see VolumeList
  std::uint32_t object = 0;  // that it belongs to
  VolumeTriangles triangles;
};

// The zip archive of a 3MF file, in which parts are found by their names in any case and with either slash.
// What an archive may unpack to is limited (docs/meshes.md): a few bytes can stand for gigabytes.
class ThreeMfPackage {
 public:
  // `file` has to stay. Throws InputError for what is no whole zip archive.
  explicit ThreeMfPackage(const InputFile& file);

  // The part that the package says to be its model, or the only one that can be.
  std::string model() const;

  // Whether there is a part of this name.
  bool has(std::string_view part) const { return find(part).has_value(); }

  // Calls f(bytes) for each block of a part. What f throws is thrown when the rest of the part is whole: else
  // its damage is the reason.
  void read(std::string_view part, const std::function<void(std::string_view)>& f) const;

  // The volumes that are not part of the model, of all lists.
  std::vector<OtherVolume> other_volumes(const std::vector<VolumeList>& lists) const;

 private:
  struct Discard {
    void operator()(zip* archive) const;
  };

  std::optional<std::uint64_t> find(std::string_view part) const;
  std::string text_of(std::string_view part) const;
  std::string model_by_relation() const;

  const InputFile& file_;
  std::unique_ptr<zip, Discard> archive_;
  std::map<std::string, std::uint64_t, std::less<>> entries_;  // by their names without case
};

}  // namespace aerate
