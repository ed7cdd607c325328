#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "batch/given_options.h"

namespace aerate::batch {

// A line of a manifest: a model, and the options that are its own.
struct ManifestRow {
  std::size_t line = 0;  // where it begins, from 1
  std::filesystem::path model = {};
  std::string output = {};  // empty where it is not named
  std::vector<GivenOption> options = {};
  std::string fault = {};  // why it cannot be done, empty where it can
};

bool is_a_manifests_name(const std::filesystem::path& path);  // .csv, .jsonl

// Rows in their order. Relative names are made relative to the manifest's folder. What is wrong with a line becomes its fault, what is wrong with all
// of them (a header with a column that is no option, text that is no table) is thrown: UsageError or InputError, with the line.
std::vector<ManifestRow> read_manifest(const std::filesystem::path& path, std::span<const OptionRule> rules);

// Records of CSV (RFC 4180; a field in quotes may hold line feeds), with the line where each begins. Throws InputError with the line for a quote that
// is never closed.
struct CsvRecord {
  std::size_t line = 1;
  std::vector<std::string> fields = {};
};
std::vector<CsvRecord> parse_csv(std::string_view text, char separator, const std::string& name);

}  // namespace aerate::batch
