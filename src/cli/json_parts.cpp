#include "cli/json_parts.h"

#include "cli/report_json.h"

namespace aerate::cli {

Json report_header(const char* command) {
  return {{"schema", std::string("aerate.") + command},
          {"schema_version", kReportSchemaVersion},
          {"program", std::string("aerate ") + AERATE_VERSION}};
}

std::string dump(const Json& json) {
  // File names may hold any bytes; what is not UTF-8 is replaced.
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace aerate::cli
