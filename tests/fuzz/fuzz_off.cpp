#include "tests/fuzz/fuzz_model.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return aerate::fuzz::read_model(aerate::MeshFormat::off, aerate::fuzz::text_of(data, size),
                                  [](const aerate::Mesh&) {});
}
