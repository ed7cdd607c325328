#include <cmath>

#include "pipeline/process_choice.h"
#include "pipeline/process_file.h"
#include "tests/fuzz/fuzz_input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const aerate::fuzz::MemoryFile kFile;
  return aerate::fuzz::run([&] {
    const aerate::Process process = aerate::read_process_file(kFile.with(aerate::fuzz::text_of(data, size)));
    for (const auto& [limit, figure] : process.limits) {
      aerate::fuzz::require(figure.value >= 0 && figure.value <= aerate::kLongest, "limits are in range");
      aerate::fuzz::require(!figure.source.empty(), "a limit says where it is from");
    }
    // A job under it: its limits are sound, or are refused.
    const aerate::PackingLimits limits =
        aerate::packing_limits(aerate::limits_under(process, {}, aerate::ProcessCheck::strict));
    aerate::fuzz::require(limits.min_radius > 0 && limits.min_radius <= limits.max_radius,
                          "radii are in order");
  });
}
