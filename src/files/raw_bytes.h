#pragma once

#include <bit>
#include <cstring>
#include <string>

// Values as the binary formats hold them.
namespace aerate {

static_assert(std::endian::native == std::endian::little,
              "binary STL and PLY are read and written as memory holds them");

template <typename T>
T value_at(const char* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof(T));
  return value;
}

template <typename T>
void append_bytes(std::string& out, const T& value) {
  char bytes[sizeof(T)];
  std::memcpy(bytes, &value, sizeof(T));
  out.append(bytes, sizeof(T));
}

}  // namespace aerate
