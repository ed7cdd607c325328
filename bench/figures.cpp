#include "bench/figures.h"

#include <cmath>
#include <cstdio>
#include <fmt/format.h>
#include <fstream>
#include <stdexcept>

namespace aerate::bench {
namespace {

void write_file(const std::string& path, const std::string& text) {
  std::ofstream file(path);
  file << text;
  if (!file.flush()) throw std::runtime_error(path + " cannot be written");
}

}  // namespace

Table::Table(const std::vector<std::string>& columns) : column_count_(columns.size()) {
  append(columns);
  append(std::vector<std::string>(columns.size(), "---"));
}

void Table::add(const std::vector<std::string>& cells) {
  if (cells.size() != column_count_) throw std::logic_error("a row has as many cells as its table");
  append(cells);
}

void Table::append(const std::vector<std::string>& cells) {
  const std::string line = fmt::format("| {} |\n", fmt::join(cells, " | "));
  fmt::print("{}", line);
  std::fflush(stdout);
  markdown_ += line;
}

std::string grouped(double count) {
  std::string digits = fmt::format("{:.0f}", std::abs(count));
  for (std::size_t end = digits.size(); end > 3; end -= 3) digits.insert(end - 3, 1, ',');
  return fmt::format("{}{}", count < 0 ? "-" : "", digits);
}

std::string hundredths(double value) {
  return fmt::format("{:.2f}", value);
}

void write_figures(const Arguments& arguments, const std::string& tables, const std::string& summary) {
  if (!arguments.table_file.empty()) write_file(arguments.table_file, tables);
  if (!arguments.summary_file.empty()) write_file(arguments.summary_file, summary);
}

}  // namespace aerate::bench
