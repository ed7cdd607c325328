#pragma once

#include <string>

#include "view/image.h"

namespace aerate {

// The bytes of a PNG file, 8 bits a colour. Throws FailureError if there is no memory for it.
std::string png_of(const Image& image);

}  // namespace aerate
