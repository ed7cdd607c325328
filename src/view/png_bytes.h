#pragma once

#include <string>
#include <string_view>

#include "view/image.h"

namespace aerate {

// The bytes of a PNG file, 8 bits a colour. Throws FailureError if there is no memory for it.
std::string png_of(const Image& image);

// The same picture, so many pixels wide; as it is if it is not wider. Throws InputError for bytes that are no PNG file, and as above.
std::string smaller_png(std::string_view bytes, int width);

}  // namespace aerate
