#include "view/png_bytes.h"

#include <csetjmp>
#include <cstddef>
#include <new>
#include <png.h>

#include "core/error.h"

namespace aerate {
namespace {

[[noreturn]] void fail(png_structp png, png_const_charp /*message*/) {
  std::longjmp(png_jmpbuf(png), 1);  // NOLINT(cert-err52-cpp): as libpng wants it
}

void ignore(png_structp /*png*/, png_const_charp /*message*/) {}

// No exception may pass through libpng.
void append(png_structp png, png_bytep bytes, std::size_t count) {
  bool is_added = true;
  try {
    static_cast<std::string*>(png_get_io_ptr(png))->append(reinterpret_cast<const char*>(bytes), count);
  } catch (const std::bad_alloc&) {
    is_added = false;
  }
  if (!is_added) png_error(png, "no memory");
}

void flush(png_structp /*png*/) {}

// No object with a destructor may be made between setjmp and what may jump back.
bool write(png_structp png, png_infop info, const Image& image, std::string& bytes) {
  if (setjmp(png_jmpbuf(png)) != 0) return false;  // NOLINT(cert-err52-cpp)
  png_set_write_fn(png, &bytes, append, flush);
  png_set_IHDR(png, info, static_cast<png_uint_32>(image.width()), static_cast<png_uint_32>(image.height()),
               8, PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
               PNG_FILTER_TYPE_DEFAULT);
  png_write_info(png, info);
  const auto width = static_cast<std::size_t>(image.width());
  static_assert(sizeof(Colour) == 3);
  for (int y = 0; y < image.height(); ++y)
    png_write_row(
        png, reinterpret_cast<png_const_bytep>(image.pixels().data() + static_cast<std::size_t>(y) * width));
  png_write_end(png, nullptr);
  return true;
}

}  // namespace

std::string png_of(const Image& image) {
  std::string bytes;
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, fail, ignore);
  png_infop info = png != nullptr ? png_create_info_struct(png) : nullptr;
  const bool is_written = info != nullptr && write(png, info, image, bytes);
  png_destroy_write_struct(&png, &info);
  if (!is_written) throw FailureError("no memory for the picture", "give a smaller --picture-size");
  return bytes;
}

}  // namespace aerate
