#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "core/monitor.h"
#include "files/load.h"
#include "kernels/vec.h"

namespace aerate {

// What a print is called.
struct PrintNames {
  std::optional<std::string> object;  // by its G-code, if that labels objects
  std::string output;                 // of its G-code, as the slicer will name it; may be empty
};

// Of the box round all extrusions of a G-code, mm.
Vec3d size_of_print(std::string_view gcode);

// The model of a print among the files of a folder: that which is called as the object, with or without its ending; without such a
// name the one with the longest name that the output's begins with. Of several those whose size is that of the print: no
// wider, since there may be a skirt round it, and as high to a millimetre. Throws InputError if none or several are left.
std::filesystem::path model_of_print(const std::filesystem::path& folder, const PrintNames& names, Vec3d size,
                                     const LoadOptions& load, Monitor& monitor);

}  // namespace aerate
