#pragma once

#include <span>
#include <string>

#include "batch/run_jobs.h"

// What the batch says of its rows, however they were done.
namespace aerate::cli {

constexpr const char* kBatchVersion = "aerate " AERATE_VERSION;

// "done: a-hollow.stl (40.1 % removed, 1.2 s)", or what came in between.
std::string told(const batch::BatchRow& row);

std::string in_time(double seconds);

// Those that need not be done and could not be, before work starts.
void tell_known_failures(std::span<const batch::BatchRow> rows);

// On the way, where it is no loss if it cannot be.
void try_to_summarise(std::span<const batch::BatchRow> rows, const std::string& results, bool is_quiet);

// The summary, and how many are done. Throws an Error of exit status 6 or 7 unless all are.
//   in_this_run: of them
void finish_batch(std::span<const batch::BatchRow> rows, const std::string& results, std::size_t in_this_run,
                  bool is_quiet);

}  // namespace aerate::cli
