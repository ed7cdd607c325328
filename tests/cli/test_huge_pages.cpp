#include <cinttypes>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <string>
#include <vector>

#include "cli/huge_pages.h"

// Memory of large arrays, in a program that has the command's `operator new`.
namespace aerate::test {
namespace {

constexpr std::size_t kMiB = std::size_t{1} << 20;

// What the kernel says of the mapping that holds an address, as in VmFlags of proc(5).
std::string flags_of(const void* address) {
  const auto at = reinterpret_cast<std::uintptr_t>(address);
  std::ifstream maps("/proc/self/smaps");
  bool holds = false;
  for (std::string line; std::getline(maps, line);) {
    std::uintptr_t first = 0, last = 0;
    if (std::sscanf(line.c_str(), "%" SCNxPTR "-%" SCNxPTR, &first, &last) == 2)
      holds = at >= first && at < last;
    if (holds && line.starts_with("VmFlags:")) return line + ' ';
  }
  return {};
}

TEST(HugePages, AreAskedForLargeArraysAlone) {
  if (!std::filesystem::exists("/sys/kernel/mm/transparent_hugepage/enabled"))
    GTEST_SKIP() << "this kernel has no transparent huge pages";
  cli::use_huge_pages();
  const std::vector<char> small(64 << 10);
  EXPECT_EQ(flags_of(small.data() + small.size() / 2).find(" hg "), std::string::npos);
  // Larger than what is kept, too: that is a mapping of its own.
  for (const std::size_t size : {5 * kMiB, 300 * kMiB}) {
    const std::vector<char> large(size);
    const std::string flags = flags_of(large.data() + size / 2);
    EXPECT_NE(flags.find(" hg "), std::string::npos) << size << ": " << flags;
  }
}

TEST(HugePages, MemoryThatIsFreedIsUsedAgain) {
  cli::use_huge_pages();
  const auto place = [] { return reinterpret_cast<std::uintptr_t>(std::vector<char>(20 * kMiB).data()); };
  const std::uintptr_t first = place();
  EXPECT_EQ(place(), first);
}

}  // namespace
}  // namespace aerate::test
