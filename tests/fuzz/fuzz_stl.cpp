#include <cstring>

#include "tests/fuzz/fuzz_model.h"

namespace {

constexpr std::size_t kHeader = 84, kFacet = 50;

// Whether the count of a binary file agrees with its size: its triangles are then as many.
bool is_binary(std::string_view bytes, std::uint32_t& count) {
  if (bytes.size() < kHeader) return false;
  std::memcpy(&count, bytes.data() + 80, sizeof count);
  return bytes.size() == kHeader + kFacet * count;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes = aerate::fuzz::text_of(data, size);
  return aerate::fuzz::read_model(aerate::MeshFormat::stl, bytes, [&](const aerate::Mesh& mesh) {
    std::uint32_t count = 0;
    if (is_binary(bytes, count))
      aerate::fuzz::require(mesh.triangles.size() == count, "as many triangles as the file has");
  });
}
