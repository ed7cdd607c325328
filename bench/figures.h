#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "bench/benchmark.h"

// Measured figures on their way into a document: tables in Markdown, and files of them for scripts/put-table.

namespace aerate::bench {

// Rows appear on standard output as soon as they are added, since some take minutes.
class Table {
 public:
  explicit Table(const std::vector<std::string>& columns);
  // As many cells as there are columns.
  void add(const std::vector<std::string>& cells);
  const std::string& markdown() const { return markdown_; }

 private:
  void append(const std::vector<std::string>& cells);

  std::size_t column_count_;
  std::string markdown_;
};

// 12,345,678
std::string grouped(double count);
// 12345678.90
std::string hundredths(double value);

// Keeps what was measured, for those files that are wanted. A table from which a model was left out, or with
// figures of a packing that breaks its limits, is none: call it only where all is well.
// Throws std::runtime_error if a file cannot be written.
void write_figures(const Arguments& arguments, const std::string& tables, const std::string& summary);

}  // namespace aerate::bench
