#pragma once

#include <string>

namespace aerate {

// Memory that this process may still take, in bytes: what the system says is available, less if the process
// is in a control group with a limit. Infinite where the system does not tell.
double available_memory_bytes();

// The most memory this process has held so far, in bytes; 0 where the system does not tell.
double peak_memory_bytes();

// "3.2 GB"
std::string format_bytes(double bytes);

}  // namespace aerate
