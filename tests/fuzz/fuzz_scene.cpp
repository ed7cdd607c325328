#include "tests/fuzz/fuzz_model.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes = aerate::fuzz::text_of(data, size);
  const aerate::MeshFormat& format = bytes.starts_with("glTF") ? aerate::MeshFormat::glb
                                     : bytes.starts_with("{")  ? aerate::MeshFormat::gltf
                                                               : aerate::MeshFormat::three_ds;
  return aerate::fuzz::read_model(format, bytes, [](const aerate::Mesh&) {});
}
