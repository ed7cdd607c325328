#include "studio/studio_json.h"

#include <fmt/format.h>
#include <utility>

#include "files/formats.h"
#include "printing/processes.h"

namespace aerate::studio {
namespace {

Json or_null(const std::optional<std::string>& text) {
  return text ? Json(*text) : Json();
}

Json json_of(const OptionRow& row) {
  Json json = {{"name", row.name},       {"kind", name_of(row.kind)},
               {"unit", row.unit},       {"default", or_null(row.default_value)},
               {"choices", row.choices}, {"description", row.description},
               {"group", row.group}};
  if (row.may_be_off) json["off"] = true;
  if (row.may_be_bare) json["bare"] = true;
  return json;
}

// The rows of limits that the command line has options for, and those that it has none for by their names.
Json json_of(const Process& process) {
  Json rows = Json::array();
  for (const LimitRow& row : limit_rows()) {
    const auto found = process.limits.find(row.limit);
    std::string option(row.option);
    if (option.starts_with("--")) option.erase(0, 2);
    Json json = {{"option", option.empty() ? Json() : Json(option)},
                 {"name", row.name},
                 {"value", nullptr},
                 {"unit", row.unit.symbol},
                 {"source", nullptr}};
    if (found != process.limits.end()) {
      json["value"] = found->second.value;
      json["source"] = found->second.source;
    }
    rows.push_back(std::move(json));
  }
  return {{"name", process.name},
          {"title", process.title},
          {"material", process.material},
          {"drains", process.drainage == Drainage::needed},
          {"rows", rows}};
}

struct Figures {
  double volume = 0, mass = 0, cost = 0;  // mm3, g, currency
};

Figures figures_of(double volume, const Material& material) {
  const double mass = volume * material.density_g_cm3 / 1000;
  return {volume, mass, mass * material.price_per_kg / 1000};
}

Json range_of(const ShareRange& range) {
  return {{"from", range.from}, {"to", range.to}};
}

std::string percents(const ShareRange& range) {
  const std::string from = fmt::format("{:.0f}", 100 * range.from),
                    to = fmt::format("{:.0f}", 100 * range.to);
  return from == to ? to + " %" : from + " to " + to + " %";
}

template <typename Records>
Json list_of(const Records& records) {
  Json list = Json::array();
  for (const auto& record : records) list.push_back(json_of(record));
  return list;
}

Refused unclear(const std::string& what) {
  return Refused({400, what, R"(send {"model": "m1", "options": {"wall": "2", "drain": true}})"});
}

GivenOption option_of(const std::string& name, const Json& value) {
  if (value.is_boolean()) return {name, {}, !value.get<bool>()};
  if (value.is_string()) return {name, {value.get<std::string>()}};
  if (!value.is_array()) throw unclear("option " + name + " is neither a text, true or false, nor a list");
  GivenOption option{name, {}};
  for (const Json& each : value) {
    if (!each.is_string()) throw unclear("option " + name + ": its list has what is no text");
    option.values.push_back(each.get<std::string>());
  }
  if (option.values.empty()) throw unclear("option " + name + ": its list is empty");
  return option;
}

}  // namespace

Json json_of(const ModelRecord& model) {
  return {{"id", model.id},       {"name", model.name},
          {"bytes", model.bytes}, {"usable", model.is_usable},
          {"use", model.use},     {"report", Json::parse(model.inspection)}};
}

Json json_of(const Refusal& refusal) {
  Json json = {{"what", refusal.what}, {"hint", refusal.hint}};
  if (refusal.exit) json["exit"] = *refusal.exit;
  return json;
}

Json json_of(const JobRecord& job) {
  Json files = Json::array();
  for (const ResultFile& file : job.files)
    files.push_back({{"form", file.form}, {"name", file.name}, {"bytes", file.bytes}});
  Json json = {{"id", job.id},
               {"model", job.model},
               {"modelName", job.model_name},
               {"options", Json::parse(job.options)},
               {"state", name_of(job.state)},
               {"waitingBefore", job.waiting_before},
               {"stage", job.stage},
               {"progress", job.progress ? Json(*job.progress) : Json()},
               {"notices", job.notices},
               {"command", job.command},
               {"files", files},
               {"seconds", job.seconds}};
  if (job.error) json["error"] = json_of(*job.error);
  return json;
}

Json json_of(const Studio::Outlook& outlook) {
  const HollowOptions& options = outlook.plan.forms.front().options;
  Json json = {{"command", outlook.plan.command},
               {"rows", Json::array()},
               {"solid", nullptr},
               {"removed", nullptr},
               {"deeper", nullptr}};
  const auto row = [&](const char* label, std::string value) {
    json["rows"].push_back({{"label", label}, {"value", std::move(value)}});
  };
  if (!outlook.estimate) {
    row("Estimate", "none: the model is open, and is meshed anew first");
    return json;
  }
  const JobEstimate& estimate = *outlook.estimate;
  const Figures solid = figures_of(estimate.solid_volume, options.material);
  json["solid"] = {{"volume", solid.volume}, {"mass", solid.mass}, {"cost", solid.cost}};
  json["removed"] = range_of(estimate.removed);
  json["deeper"] = range_of(estimate.deeper);
  row("Solid",
      fmt::format("{:.4g} cm3, {:.4g} g of {}", solid.volume / 1000, solid.mass, options.material.name));
  row("Deeper than the wall", percents(estimate.deeper));
  if (estimate.removed.to <= 0) {
    row(options.modifiers ? "Modifiers" : "Removed", "nothing: no room is deep enough");
    return json;
  }
  row(options.modifiers ? "Modifiers fill, about" : "Removed, about", percents(estimate.removed));
  if (options.modifiers) return json;
  row("Saves, about", fmt::format("{:.3g} to {:.3g} g of solid {}", estimate.removed.from * solid.mass,
                                  estimate.removed.to * solid.mass, options.material.name));
  if (options.infill_is_known) row("Filament", "what the print takes is predicted by the job itself");
  return json;
}

Json state_of(const Studio& studio) {
  const Changes all = studio.changes_after(0, {});
  Json formats = Json::array();
  for (const MeshFormat* format : kMeshFormats) formats.push_back(format->ending);
  const Bounds& bounds = studio.bounds();
  return {{"version", "aerate " AERATE_VERSION},
          {"limits",
           {{"bodyBytes", bounds.body_bytes},
            {"models", bounds.models},
            {"jobs", bounds.jobs},
            {"formats", formats}}},
          {"options", list_of(studio.lent().options)},
          {"processes", list_of(processes())},
          {"models", list_of(all.models)},
          {"jobs", list_of(all.jobs)}};
}

std::string text_of(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

JobRequest parse_job_request(std::string_view body) {
  const Json json = Json::parse(body, nullptr, false);
  if (!json.is_object() || !json.contains("model") || !json["model"].is_string())
    throw unclear("the request names no model");
  JobRequest request{.model = json["model"].get<std::string>(), .options_as_sent = "{}"};
  if (!json.contains("options")) return request;
  const Json& options = json["options"];
  if (!options.is_object()) throw unclear("the options are no object");
  for (const auto& [name, value] : options.items()) request.options.push_back(option_of(name, value));
  request.options_as_sent = text_of(options);
  return request;
}

}  // namespace aerate::studio
