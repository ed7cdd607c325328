#include "view/png_bytes.h"

#include <algorithm>
#include <array>
#include <csetjmp>
#include <cstddef>
#include <cstdint>
#include <new>
#include <png.h>
#include <vector>

#include "core/error.h"

namespace aerate {
namespace {

constexpr double kMostPixelsThatAreRead = 1e8;

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

// Each pixel is the mean of those that lie in its place.
Image averaged(const Image& image, int width) {
  const int height =
      std::max(1, static_cast<int>(static_cast<long long>(image.height()) * width / image.width()));
  Image smaller(width, height, {});
  const auto edge = [](int i, int all, int parts) {
    return static_cast<int>(static_cast<long long>(i) * all / parts);
  };
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      std::array<int, 3> sum{};
      int count = 0;
      for (int row = edge(y, image.height(), height); row < edge(y + 1, image.height(), height); ++row) {
        for (int column = edge(x, image.width(), width); column < edge(x + 1, image.width(), width);
             ++column) {
          const Colour colour = image.at(column, row);
          sum[0] += colour.red;
          sum[1] += colour.green;
          sum[2] += colour.blue;
          ++count;
        }
      }
      const auto mean = [&](int of) {
        return static_cast<std::uint8_t>((of + count / 2) / std::max(count, 1));
      };
      smaller.set(x, y, {mean(sum[0]), mean(sum[1]), mean(sum[2])});
    }
  }
  return smaller;
}

Image image_in(std::string_view bytes) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  const auto refuse = [&]() {
    InputError error(std::string("no picture: ") + png.message);
    png_image_free(&png);
    return error;
  };
  if (png_image_begin_read_from_memory(&png, bytes.data(), bytes.size()) == 0) throw refuse();
  if (png.width == 0 || png.height == 0 ||
      static_cast<double>(png.width) * static_cast<double>(png.height) > kMostPixelsThatAreRead) {
    png_image_free(&png);
    throw InputError("no picture: its size is not one that pictures have");
  }
  png.format = PNG_FORMAT_RGB;
  std::vector<std::uint8_t> values(PNG_IMAGE_SIZE(png));
  if (png_image_finish_read(&png, nullptr, values.data(), 0, nullptr) == 0) throw refuse();
  Image image(static_cast<int>(png.width), static_cast<int>(png.height), {});
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      const std::size_t at = 3 * (static_cast<std::size_t>(y) * png.width + static_cast<std::size_t>(x));
      image.set(x, y, {values[at], values[at + 1], values[at + 2]});
    }
  }
  return image;
}

}  // namespace

std::string smaller_png(std::string_view bytes, int width) {
  const Image image = image_in(bytes);
  return image.width() <= width ? std::string(bytes) : png_of(averaged(image, width));
}

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
