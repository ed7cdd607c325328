#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/best_form.h"
#include "pipeline/report.h"

// What the studio has from the command line, so that both have the same options and say the same words.

namespace aerate::studio {

// An option of a job as it was sent, by its long name without dashes.
struct GivenOption {
  std::string name;
  std::vector<std::string> values;  // none of a flag
  bool is_off = false;              // a flag that is turned off
};

enum class OptionKind { number, text, choice, flag, list };
const char* name_of(OptionKind kind);

// One that may be given.
struct OptionRow {
  std::string name;
  OptionKind kind = OptionKind::text;
  std::string unit = {};  // "mm", empty where there is none
  std::optional<std::string> default_value = {};
  std::vector<std::string> choices = {};
  std::string description = {}, group = {};
  bool may_be_off = false;   // a flag that may be turned off, where the process turns it on
  bool may_be_bare = false;  // as a flag, without its value
};

// What is to be done with a model that the studio keeps.
struct PlanRequest {
  std::filesystem::path model;  // its file
  std::string name;             // what the user calls it: "bunny.stl"
  std::filesystem::path stem;   // of the result, without its ending
  std::vector<GivenOption> options;
};

struct Plan {
  std::vector<JobForm> forms = {};  // their output is the stem with an ending
  std::string output_name = {};     // what the user is to call it: "bunny-hollow.stl"
  std::string command = {};         // the command line that does the same
};

struct Lent {
  std::vector<OptionRow> options;
  // Throws UsageError as the command line does, and for an option that is none of the rows or names a file.
  std::function<Plan(const PlanRequest&)> plan;
  std::function<std::string(const HollowReport&)> report_text, report_json;
  std::function<std::string(const InspectReport&)> inspection_json;
};

}  // namespace aerate::studio
