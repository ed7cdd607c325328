#include "batch/manifest.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "core/error.h"
#include "files/input_file.h"

namespace aerate::batch {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr std::string_view kModel = "model", kOutput = "output";
constexpr const char* kColumns =
    "a manifest has 'model', 'output' and the long names of the options of 'aerate hollow' without dashes";
constexpr std::size_t kMostBytes = std::size_t{1} << 28;

std::string in_lower_case(std::string text) {
  std::ranges::transform(text, text.begin(),
                         [](unsigned char byte) { return static_cast<char>(std::tolower(byte)); });
  return text;
}

std::optional<bool> parse_truth(const std::string& text) {
  const std::string lower = in_lower_case(text);
  for (const char* yes : {"true", "yes", "on", "1"})
    if (lower == yes) return true;
  for (const char* no : {"false", "no", "off", "0"})
    if (lower == no) return false;
  return std::nullopt;
}

class Reader {
 public:
  Reader(const fs::path& path, std::span<const OptionRule> rules)
      : name_(path.string()), folder_(path.parent_path()), rules_(rules) {}

  bool is_known(std::string_view column) const {
    return column == kModel || column == kOutput || find_rule(rules_, column) != nullptr;
  }

  // Sets what a cell says; an empty one says nothing.
  void set(ManifestRow& row, const std::string& column, const std::vector<std::string>& values) const {
    if (column == kModel) {
      row.model = relative(values.front());
    } else if (column == kOutput) {
      row.output = values.front();
    } else {
      row.options.push_back(option(*find_rule(rules_, column), values));
    }
  }

 private:
  fs::path relative(const std::string& file) const {
    return folder_.empty() || fs::path(file).is_absolute() ? fs::path(file) : folder_ / file;
  }

  // A value that may be a file beside the manifest.
  std::string value_of(const OptionRule& rule, const std::string& value) const {
    std::error_code ignored;
    if (rule.names_file || fs::is_regular_file(relative(value), ignored)) return relative(value).string();
    return value;
  }

  GivenOption option(const OptionRule& rule, const std::vector<std::string>& values) const {
    GivenOption given{.name = rule.name};
    const std::optional<bool> truth = parse_truth(values.front());
    const bool may_be_truth = rule.kind == OptionRule::Kind::flag || rule.may_be_bare;
    const bool is_digit = values.front() == "0" || values.front() == "1";  // a value where there may be one
    if (may_be_truth && truth && !(rule.may_be_bare && is_digit)) {
      given.is_off = !*truth;
      return given;
    }
    if (rule.kind == OptionRule::Kind::flag)
      throw UsageError(fmt::format("{}: '{}' is neither true nor false", rule.name, values.front()));
    if (rule.kind != OptionRule::Kind::list && values.size() > 1)
      throw UsageError(fmt::format("{} takes one value", rule.name));
    for (const std::string& value : values) given.values.push_back(value_of(rule, value));
    return given;
  }

  std::string name_;
  fs::path folder_;
  std::span<const OptionRule> rules_;
};

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts;
  for (std::size_t start = 0; start <= text.size();) {
    const std::size_t end = std::min(text.find(separator, start), text.size());
    if (end > start) parts.push_back(text.substr(start, end - start));
    start = end + 1;
  }
  return parts;
}

// A header in which commas are absent has semicolons, as spreadsheets of many countries write them.
char separator_of(std::string_view text) {
  const std::string_view header = text.substr(0, text.find('\n'));
  return header.find(',') == std::string_view::npos && header.find(';') != std::string_view::npos ? ';' : ',';
}

std::vector<ManifestRow> rows_of_csv(const std::string& name, std::string_view text, const Reader& reader,
                                     std::span<const OptionRule> rules) {
  const std::vector<CsvRecord> records = parse_csv(text, separator_of(text), name);
  if (records.empty()) throw InputError(fmt::format("{}: it is empty", name), kColumns);
  const CsvRecord& header = records.front();
  for (const std::string& column : header.fields)
    if (!reader.is_known(column))
      throw UsageError(fmt::format("{}: line {}: column '{}' is no option", name, header.line, column),
                       kColumns);
  for (const std::string& column : header.fields)
    if (std::ranges::count(header.fields, column) > 1)
      throw UsageError(fmt::format("{}: line {}: column '{}' is there twice", name, header.line, column),
                       kColumns);
  if (std::ranges::find(header.fields, kModel) == header.fields.end())
    throw UsageError(fmt::format("{}: line {}: there is no column 'model'", name, header.line), kColumns);
  std::vector<ManifestRow> rows;
  rows.reserve(records.size() - 1);
  for (const CsvRecord& record : std::span(records).subspan(1)) {
    ManifestRow& row = rows.emplace_back(ManifestRow{.line = record.line});
    if (record.fields.size() > header.fields.size()) {
      row.fault = fmt::format("{} fields under {} columns", record.fields.size(), header.fields.size());
      continue;
    }
    try {
      for (std::size_t i = 0; i < record.fields.size(); ++i) {
        const std::string& column = header.fields[i];
        const OptionRule* const rule = find_rule(rules, column);
        const bool is_list = rule != nullptr && rule->kind == OptionRule::Kind::list;
        if (!record.fields[i].empty())
          reader.set(row, column, is_list ? split(record.fields[i], ';') : std::vector{record.fields[i]});
      }
    } catch (const Error& error) {
      row.fault = error.what();
    }
  }
  return rows;
}

std::string text_of(const Json& value) {
  if (value.is_string()) return value.get<std::string>();
  if (value.is_number() || value.is_boolean()) return value.dump();
  throw UsageError("a value is neither text, number, true nor false");
}

std::vector<std::string> texts_of(const Json& value) {
  if (!value.is_array()) return {text_of(value)};
  std::vector<std::string> texts;
  for (const Json& each : value) texts.push_back(text_of(each));
  return texts;
}

ManifestRow row_of_line(std::string_view line, std::size_t number, const Reader& reader) {
  ManifestRow row{.line = number};
  try {
    // Nesting that is deep enough to take the stack cannot come to be: a value's parts have no parts.
    const auto shallow = [](int depth, Json::parse_event_t, Json&) {
      if (depth > 2) throw UsageError("a value is nested too deeply");
      return true;
    };
    const Json object = Json::parse(line, shallow);
    if (!object.is_object()) throw UsageError("it is no object { .. }");
    for (const auto& [key, value] : object.items()) {
      if (!reader.is_known(key)) throw UsageError(fmt::format("'{}' is no option", key));
      if (value.is_null()) continue;
      const std::vector<std::string> values = texts_of(value);
      if (!values.empty() && !(values.size() == 1 && values.front().empty())) reader.set(row, key, values);
    }
  } catch (const Json::exception&) {
    row.fault = "it is no JSON";
  } catch (const Error& error) {
    row.fault = error.what();
  }
  return row;
}

std::vector<ManifestRow> rows_of_json_lines(std::string_view text, const Reader& reader) {
  std::vector<ManifestRow> rows;
  for (std::size_t number = 1; !text.empty(); ++number) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, end);
    if (line.find_first_not_of(" \t\r") != std::string_view::npos)
      rows.push_back(row_of_line(line, number, reader));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return rows;
}

}  // namespace

bool is_a_manifests_name(const fs::path& path) {
  const std::string ending = in_lower_case(path.extension().string());
  return ending == ".csv" || ending == ".jsonl";
}

std::vector<CsvRecord> parse_csv(std::string_view text, char separator, const std::string& name) {
  std::vector<CsvRecord> records;
  std::size_t line = 1;
  while (!text.empty()) {
    CsvRecord record{.line = line};
    bool is_blank = true;
    for (bool is_last = false; !is_last;) {
      std::string& field = record.fields.emplace_back();
      const bool is_quoted = text.starts_with('"');
      if (is_quoted) {
        is_blank = false;
        text.remove_prefix(1);
        for (;;) {
          const std::size_t quote = text.find('"');
          if (quote == std::string_view::npos)
            throw InputError(fmt::format("{}: line {}: a quote is never closed", name, record.line));
          line += static_cast<std::size_t>(std::ranges::count(text.substr(0, quote), '\n'));
          field += text.substr(0, quote);
          text.remove_prefix(quote + 1);
          if (!text.starts_with('"')) break;
          field += '"';
          text.remove_prefix(1);
        }
      }
      const std::array ends{separator, '\n'};
      const std::size_t end =
          std::min(text.find_first_of(std::string_view(ends.data(), ends.size())), text.size());
      std::string_view rest = text.substr(0, end);
      is_last = end == text.size() || text[end] == '\n';
      if (is_last && rest.ends_with('\r')) rest.remove_suffix(1);
      field += rest;
      is_blank = is_blank && field.empty() && is_last && record.fields.size() == 1;
      text.remove_prefix(std::min(end + 1, text.size()));
    }
    ++line;
    if (!is_blank) records.push_back(std::move(record));
  }
  return records;
}

std::vector<ManifestRow> read_manifest(const fs::path& path, std::span<const OptionRule> rules) {
  const InputFile file = read_file(path, kMostBytes);
  std::string_view text = file.text();
  constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
  if (text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
  const Reader reader(path, rules);
  const bool is_table = in_lower_case(path.extension().string()) == ".csv";
  std::vector<ManifestRow> rows =
      is_table ? rows_of_csv(path.string(), text, reader, rules) : rows_of_json_lines(text, reader);
  for (ManifestRow& row : rows)
    if (row.fault.empty() && row.model.empty()) row.fault = "it names no model";
  return rows;
}

}  // namespace aerate::batch
