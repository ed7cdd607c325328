#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "studio/lent.h"
#include "studio/records.h"
#include "studio/refusal.h"
#include "studio/studio.h"

// What goes over the wire, as docs/studio.md says.

namespace aerate::studio {

using Json = nlohmann::ordered_json;

Json json_of(const ModelRecord& model);
Json json_of(const JobRecord& job);
Json json_of(const Refusal& refusal);

Json json_of(const Studio::Outlook& outlook);

// Everything that a tab needs to show what there is.
Json state_of(const Studio& studio);

// In UTF-8; bytes that are none are replaced.
std::string text_of(const Json& json);

// A model and options, as requests send them: {"model": "m1", "options": {"wall": "2", "drain": true, "holes-on": ["top"]}}.
struct JobRequest {
  std::string model;
  std::vector<GivenOption> options = {};
  std::string options_as_sent;
};
// Throws Refused (400) for what is not such.
JobRequest parse_job_request(std::string_view body);

}  // namespace aerate::studio
