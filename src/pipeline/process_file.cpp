#include "pipeline/process_file.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <string>
#include <system_error>

#include "core/error.h"
#include "files/input_file.h"

namespace aerate {
namespace {

using Json = nlohmann::json;

constexpr const char* kHint =
    "docs/processes.md describes process files; '--process list' names all that are found by name";

Json parse(const std::filesystem::path& path) {
  constexpr std::size_t kMostBytes = std::size_t{1} << 20;
  try {
    return Json::parse(read_file(path, kMostBytes).text());
  } catch (const InputError& error) {
    throw InputError(fmt::format("the process file cannot be read: {}", error.what()),
                     "a process is a name that '--process list' has, or the path of a .json file");
  } catch (const Json::exception& error) {
    throw InputError(fmt::format("{}: not JSON: {:.200}", path.string(), error.what()), kHint);
  }
}

[[noreturn]] void refuse(const std::filesystem::path& path, const std::string& what) {
  throw UsageError(fmt::format("{}: {}", path.string(), what), kHint);
}

std::string text_of(const std::filesystem::path& path, const std::string& key, const Json& value) {
  if (!value.is_string()) refuse(path, fmt::format("\"{}\" is not a text", key));
  return value.get<std::string>();
}

LimitValue figure_of(const std::filesystem::path& path, const std::string& key, const Json& given) {
  const bool has_source = given.is_object();
  if (has_source && (!given.contains("value") || given.size() > (given.contains("source") ? 2U : 1U)))
    refuse(path, fmt::format("\"{}\" must be a number or {{\"value\": .., \"source\": ..}}", key));
  const Json& number = has_source ? given.at("value") : given;
  if (!number.is_number()) refuse(path, fmt::format("\"{}\" is not a number", key));
  const auto value = number.get<double>();
  if (!std::isfinite(value) || value < 0 || value > kLongest)
    refuse(path, fmt::format("\"{}\" is {}, which is out of range", key, value));
  std::string source = path.filename().string();
  if (has_source && given.contains("source")) source += ": " + text_of(path, "source", given.at("source"));
  return {value, source};
}

Process base_of(const std::filesystem::path& path, const Json& json) {
  const std::string name = json.contains("base") ? text_of(path, "base", json.at("base")) : "fdm";
  const Process* base = find_process(name);
  if (base == nullptr) refuse(path, fmt::format("unknown base \"{}\"", name));
  Process process = *base;
  process.name = path.stem().string();
  for (auto& [limit, figure] : process.limits)
    figure.source = fmt::format("base {}: {}", name, figure.source);
  return process;
}

}  // namespace

Process read_process_file(const std::filesystem::path& path) {
  const Json json = parse(path);
  if (!json.is_object()) refuse(path, "a process file holds one JSON object");
  Process process = base_of(path, json);
  for (const auto& [key, value] : json.items()) {
    if (const auto row = std::ranges::find(limit_rows(), key, &LimitRow::name); row != limit_rows().end()) {
      process.limits[row->limit] = figure_of(path, key, value);
    } else if (key == "name") {
      process.name = text_of(path, key, value);
    } else if (key == "title") {
      process.title = text_of(path, key, value);
    } else if (key == "material") {
      process.material = text_of(path, key, value);
    } else if (key == "drainage") {
      if (!value.is_boolean()) refuse(path, "\"drainage\" is neither true nor false");
      process.drainage = value.get<bool>() ? Drainage::needed : Drainage::not_needed;
    } else if (key != "base") {
      refuse(path, fmt::format("unknown key \"{}\"", key));
    }
  }
  // Else the base's cells would be larger than what the file says of voids.
  if (json.contains("max-radius") && !json.contains("cell-size")) process.limits.erase(Limit::cell_size);
  const bool has_overhang = process.limits.contains(Limit::overhang);
  const bool gives_one = json.contains("overhang") || json.contains("bridge");
  if (gives_one && !(has_overhang && process.limits.contains(Limit::bridge))) {
    refuse(path,
           fmt::format("a limit for ceilings needs both \"overhang\" and \"bridge\", there is no \"{}\"",
                       has_overhang ? "bridge" : "overhang"));
  }
  return process;
}

}  // namespace aerate
