#pragma once

#include <cstddef>
#include <optional>

#include "files/input_file.h"
#include "files/load.h"

namespace aerate {

// Reads a file through assimp, which is lenient: it reads past missing data with zeros, leaves out what it
// cannot use and trusts the counts of a header with memory. So the room of a format looks through the whole
// file before, and says how many faces (of any number of corners) it promises. `extension` is lower case
// without its dot; `factor` converts a coordinate to millimetres. Throws InputError for what assimp refuses,
// for coordinates that are not finite, and where faces are missing.
LoadedModel import_with_assimp(const InputFile& file, const char* extension,
                               std::optional<std::size_t> promised_faces, double factor);

}  // namespace aerate
