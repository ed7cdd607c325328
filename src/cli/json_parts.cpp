#include "cli/json_parts.h"

namespace aerate::cli {
namespace {

// Version of the JSON schemas of docs/report.md: grows when a field changes its meaning or goes away, not
// when one is added.
constexpr int kReportSchemaVersion = 1;

}  // namespace

Json report_header(const char* command) {
  return {{"schema", std::string("aerate.") + command},
          {"schema_version", kReportSchemaVersion},
          {"program", std::string("aerate ") + AERATE_VERSION}};
}

void add_closing(Json& json, const std::vector<StageCost>& stages, const std::vector<std::string>& notices) {
  Json list = Json::array();
  for (const StageCost& stage : stages)
    list.push_back(
        {{"name", stage.name}, {"seconds", stage.seconds}, {"peak_memory_bytes", stage.peak_bytes}});
  const StageCost total = total_of(stages);
  json["stages"] = list;
  json["seconds"] = total.seconds;
  json["peak_memory_bytes"] = total.peak_bytes;
  json["notices"] = notices;
}

std::string dump(const Json& json) {
  // File names may hold any bytes; what is not UTF-8 is replaced.
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace aerate::cli
