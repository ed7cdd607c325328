#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

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

// One object and a newline, in UTF-8.
std::string dump(const Json& json);

}  // namespace aerate::cli
