#pragma once

#include <vector>

#include "files/input_file.h"
#include "files/load.h"

namespace aerate {

// Looks through a 3MF package before lib3mf reads it: a whole zip archive that holds a model, with the
// checksums of what is needed of it. Takes out what the package says to have and has not. Throws InputError.
void check_3mf(InputFile& file);

// Throws InputError for a package that has one of these lists with a volume that is not part of the model.
void require_model_parts_only(const InputFile& file, const std::vector<VolumeList>& lists);

}  // namespace aerate
