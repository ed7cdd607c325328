#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "batch/run_jobs.h"

namespace aerate::batch {

struct Counts {
  std::size_t done = 0, not_done = 0, yet_to_do = 0;  // not_done: refused, failed, crashed
};
Counts counts_of(std::span<const BatchRow> rows);

// One row for each model, in the order of the batch. CSV has names byte for byte; in JSON what is no UTF-8 is replaced, and the page shows it as
// `printable` does.
std::string summary_csv(std::span<const BatchRow> rows);
std::string summary_json(std::span<const BatchRow> rows, const std::string& version);
// A page of its own, without script, with the small pictures of the folder of results.
std::string summary_html(std::span<const BatchRow> rows, const std::filesystem::path& results,
                         const std::string& version);

// All three, beside the results; each is written whole or not at all. Throws FailureError.
void write_summary(std::span<const BatchRow> rows, const std::filesystem::path& results,
                   const std::string& version);

}  // namespace aerate::batch
