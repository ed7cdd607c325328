#include "cli/huge_pages.h"

#include <cstddef>
#include <cstdlib>

#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)

#include <malloc.h>
#include <memory>
#include <new>
#include <sys/mman.h>

namespace aerate::cli {
namespace {

constexpr std::size_t kHugePage = std::size_t{2} << 20;
// Freed memory up to this goes to the next array and not back to the system.
constexpr int kKept = 256 << 20;

// The huge pages that lie within a block. It is advice: where it is not followed, pages are small.
void advise(void* block, std::size_t size) {
  void* first = block;
  std::size_t space = size;
  if (std::align(kHugePage, kHugePage, first, space) == nullptr) return;
  madvise(first, space / kHugePage * kHugePage, MADV_HUGEPAGE);
}

}  // namespace

void use_huge_pages() {
  mallopt(M_MMAP_THRESHOLD, kKept);
  mallopt(M_TRIM_THRESHOLD, kKept);
}

}  // namespace aerate::cli

// As the standard's, but for the advice.
void* operator new(std::size_t size) {
  void* block = nullptr;
  while ((block = std::malloc(size > 0 ? size : 1)) == nullptr) {
    const std::new_handler handler = std::get_new_handler();
    if (handler == nullptr) throw std::bad_alloc();
    handler();
  }
  if (size >= aerate::cli::kHugePage) aerate::cli::advise(block, size);
  return block;
}

void operator delete(void* block) noexcept {
  std::free(block);
}

void operator delete(void* block, std::size_t) noexcept {
  std::free(block);
}

#else

namespace aerate::cli {

void use_huge_pages() {}

}  // namespace aerate::cli

#endif
