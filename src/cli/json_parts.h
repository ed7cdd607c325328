#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/report.h"

namespace aerate::cli {

// What the JSON reports of all commands are made of. Fields keep their order.
using Json = nlohmann::ordered_json;

// The fields that a report begins with.
Json report_header(const char* command);

// null where there is none.
template <typename T>
Json or_null(const std::optional<T>& value) {
  return value ? Json(*value) : Json(nullptr);
}

// The fields that a report of a job ends with: stages, time, memory, notices.
void add_closing(Json& json, const std::vector<StageCost>& stages, const std::vector<std::string>& notices);

// One object and a newline, in UTF-8.
std::string dump(const Json& json);

}  // namespace aerate::cli
