#pragma once

namespace aerate::cli {

// Large arrays get pages of 2 MiB where the kernel has them (transparent huge pages), and their memory is used again instead of
// returned: with pages of 4 KiB faults take a quarter of a job on a large model. Peak memory stays about what it was. For a
// program's beginning; a program that links this has its `operator new`. Does nothing without glibc and under sanitizers.
void use_huge_pages();

}  // namespace aerate::cli
