#include "batch/summary.h"

#include <array>
#include <cstdint>
#include <fmt/format.h>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <string_view>
#include <system_error>

#include "batch/job_state.h"
#include "core/printable.h"
#include "files/output_file.h"

namespace aerate::batch {
namespace {

namespace fs = std::filesystem;
using OrderedJson = nlohmann::ordered_json;

std::string number(const std::optional<double>& value) {
  return value ? fmt::format("{}", *value) : std::string();
}

std::string csv_field(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char byte : text) quoted += byte == '"' ? std::string("\"\"") : std::string(1, byte);
  return quoted + "\"";
}

std::string escaped(std::string_view text) {
  std::string html;
  for (const char byte : printable(text)) {
    switch (byte) {
      case '&':
        html += "&amp;";
        break;
      case '<':
        html += "&lt;";
        break;
      case '>':
        html += "&gt;";
        break;
      case '"':
        html += "&quot;";
        break;
      case '\'':
        html += "&#39;";
        break;
      default:
        html += byte;
    }
  }
  return html;
}

// A path as a relative address: what is no plain letter, digit or slash is written by its bytes.
std::string address_of(const fs::path& path) {
  std::string address = "./";
  for (const char byte : path.string()) {
    const bool is_plain = (byte >= 'a' && byte <= 'z') || (byte >= 'A' && byte <= 'Z') ||
                          (byte >= '0' && byte <= '9') ||
                          std::string_view("-_./").find(byte) != std::string_view::npos;
    address += is_plain ? std::string(1, byte) : fmt::format("%{:02X}", static_cast<unsigned char>(byte));
  }
  return address;
}

std::string base64(std::string_view bytes) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t group = 0;
    for (std::size_t j = 0; j < 3; ++j)
      group = group << 8 | (i + j < bytes.size() ? static_cast<unsigned char>(bytes[i + j]) : 0U);
    for (std::size_t digit = 0; digit < 4; ++digit)
      text += i + digit > bytes.size() ? '=' : kDigits[group >> (18 - 6 * digit) & 63];
  }
  return text;
}

std::string bytes_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream bytes;
  bytes << file.rdbuf();
  return bytes.str();
}

// Of the models that are done and have it.
std::optional<double> total(std::span<const BatchRow> rows, std::optional<double> Figures::*figure) {
  std::optional<double> sum;
  for (const BatchRow& row : rows)
    if (const auto& value = row.record.figures.*figure; value) sum = sum.value_or(0) + *value;
  return sum;
}

double total_seconds(std::span<const BatchRow> rows) {
  double sum = 0;
  for (const BatchRow& row : rows) sum += row.record.seconds;
  return sum;
}

// For people: as many digits as are of use.
std::string shown(const std::optional<double>& value, std::string_view unit, int digits) {
  return value ? fmt::format("{:.{}f}{}", *value, digits, unit) : std::string("&ndash;");
}

constexpr const char* kStyle = R"(
:root { color-scheme: light dark; font: 15px/1.4 system-ui, sans-serif; }
body { margin: 2rem auto; max-width: 80rem; padding: 0 1rem; }
table { border-collapse: collapse; width: 100%; }
th, td { padding: .35rem .6rem; text-align: right; vertical-align: middle; border-bottom: 1px solid #8884; }
th { font-weight: 600; } th:nth-child(-n+2), td:nth-child(-n+2) { text-align: left; }
td:nth-child(2) { overflow-wrap: anywhere; }
img { display: block; width: 100px; height: auto; background: #fff; }
tr.fault td { color: #b3261e; text-align: left; } @media (prefers-color-scheme: dark) { tr.fault td { color: #ff9a92; } }
tfoot td { font-weight: 600; border-top: 2px solid #888; } small { display: block; opacity: .75; }
@media print { body { margin: 0; max-width: none; } tr { break-inside: avoid; } }
)";

// Mass or cost, before and after.
std::string change(const std::optional<double>& before, const std::optional<double>& after,
                   std::string_view unit, int digits) {
  if (!before || !after) return "&ndash;";
  return fmt::format("{} &rarr; {}", shown(before, "", digits), shown(after, unit, digits));
}

std::string figure_cells(const Figures& figures, double seconds) {
  constexpr double kCubicMillimetres = 1000;
  std::optional<double> removed = figures.removed_mm3;
  if (removed) *removed /= kCubicMillimetres;
  return fmt::format("<td>{}<td>{}<td>{}<td>{}<td>{}<td>{}<td>{:.1f} s", shown(figures.voids, "", 0),
                     shown(removed, " cm&sup3;", 2), shown(figures.removed_percent, " %", 1),
                     change(figures.mass_before_g, figures.mass_after_g, " g", 1),
                     change(figures.cost_before, figures.cost_after, "", 2),
                     shown(figures.filament_change_percent, " %", 1), seconds);
}

std::string html_row(const BatchRow& row, const fs::path& results) {
  const PlannedJob& job = *row.job;
  const JobRecord& record = row.record;
  const std::string model = escaped(job.model.string());
  if (record.outcome != Outcome::done)
    return fmt::format("<tr class=fault><td><td>{}<td colspan=7>{}: {}\n", model, name_of(record.outcome),
                       escaped(record.message));
  std::string picture;
  if (!job.paths.picture.empty())
    picture = fmt::format("<a href=\"{}\"><img alt=\"\" src=\"data:image/png;base64,{}\"></a>",
                          address_of(job.paths.picture.lexically_relative(results)),
                          base64(bytes_of(thumbnail_path(results, job))));
  return fmt::format("<tr><td>{}<td><a href=\"{}\">{}</a><small>{}</small>{}\n", picture,
                     address_of(job.name), escaped(job.name.string()), model,
                     figure_cells(record.figures, record.seconds));
}

}  // namespace

Counts counts_of(std::span<const BatchRow> rows) {
  Counts counts;
  for (const BatchRow& row : rows) {
    std::size_t& count = row.record.outcome == Outcome::done       ? counts.done
                         : row.record.outcome == Outcome::not_done ? counts.yet_to_do
                                                                   : counts.not_done;
    ++count;
  }
  return counts;
}

std::string summary_csv(std::span<const BatchRow> rows) {
  std::string csv = "n,model,origin,result,outcome,exit_status,message";
  for (const FigureRow& row : kFigureRows) csv.append(",").append(row.name);
  csv += ",seconds,seconds_in_job,peak_memory_bytes\n";
  for (const BatchRow& row : rows) {
    const PlannedJob& job = *row.job;
    const JobRecord& record = row.record;
    csv += fmt::format("{},{},{},{},{},{},{}", job.number, csv_field(job.model.string()),
                       csv_field(job.origin), csv_field(job.name.string()), name_of(record.outcome),
                       record.exit_code, csv_field(record.message));
    for (const FigureRow& figure : kFigureRows) csv.append(",").append(number(record.figures.*figure.figure));
    csv += fmt::format(",{:.3f},{:.3f},{:.0f}\n", record.seconds, record.seconds_in_job,
                       record.peak_memory_bytes);
  }
  return csv;
}

std::string summary_json(std::span<const BatchRow> rows, const std::string& version) {
  const auto or_null = [](const std::optional<double>& value) {
    return value ? OrderedJson(*value) : OrderedJson(nullptr);
  };
  const Counts counts = counts_of(rows);
  OrderedJson totals{{"done", counts.done}, {"not_done", counts.not_done}, {"yet_to_do", counts.yet_to_do}};
  for (const FigureRow& row : kFigureRows)
    if (row.is_summed) totals[row.name] = or_null(total(rows, row.figure));
  totals["seconds"] = total_seconds(rows);
  OrderedJson models = OrderedJson::array();
  for (const BatchRow& row : rows) {
    const PlannedJob& job = *row.job;
    const JobRecord& record = row.record;
    OrderedJson model{
        {"n", job.number},
        {"model", job.model.string()},
        {"origin", job.origin.empty() ? OrderedJson(nullptr) : OrderedJson(job.origin)},
        {"result", job.name.empty() ? OrderedJson(nullptr) : OrderedJson(job.name.string())},
        {"outcome", name_of(record.outcome)},
        {"exit_status", record.exit_code},
        {"message", record.message.empty() ? OrderedJson(nullptr) : OrderedJson(record.message)}};
    for (const FigureRow& figure : kFigureRows) model[figure.name] = or_null(record.figures.*figure.figure);
    model["seconds"] = record.seconds;
    model["seconds_in_job"] = record.seconds_in_job;
    model["peak_memory_bytes"] = record.peak_memory_bytes;
    models.push_back(std::move(model));
  }
  const OrderedJson json{{"schema", "aerate.batch"},
                         {"schema_version", 1},
                         {"program", version},
                         {"totals", totals},
                         {"models", models}};
  return json.dump(2, ' ', false, OrderedJson::error_handler_t::replace) + "\n";
}

std::string summary_html(std::span<const BatchRow> rows, const fs::path& results,
                         const std::string& version) {
  const Counts counts = counts_of(rows);
  std::string html = fmt::format(
      "<!doctype html>\n<html lang=en><meta charset=utf-8><meta name=viewport content=\"width=device-width\">"
      "<title>aerate batch</title><style>{}</style>\n<h1>{} of {} models hollowed</h1>\n",
      kStyle, counts.done, rows.size());
  if (counts.not_done > 0)
    html += fmt::format("<p>{} could not be, for the reasons below.\n", counts.not_done);
  if (counts.yet_to_do > 0)
    html += fmt::format("<p>{} {} yet to be done: the same command goes on.\n", counts.yet_to_do,
                        counts.yet_to_do == 1 ? "is" : "are");
  html +=
      "<table><thead><tr><th>Picture<th>Result<th>Voids<th>Removed<th>Share<th>Mass<th>Cost<th>Filament"
      "<th>Time</thead>\n<tbody>\n";
  for (const BatchRow& row : rows) html += html_row(row, results);
  Figures totals;
  for (const FigureRow& row : kFigureRows)
    if (row.is_summed) totals.*row.figure = total(rows, row.figure);
  if (totals.removed_mm3 && totals.volume_before_mm3 && *totals.volume_before_mm3 > 0)
    totals.removed_percent = 100 * *totals.removed_mm3 / *totals.volume_before_mm3;
  html += fmt::format("</tbody>\n<tfoot><tr><td><td>All{}</tfoot></table>\n<p><small>{}</small>\n</html>\n",
                      figure_cells(totals, total_seconds(rows)), escaped(version));
  return html;
}

void write_summary(std::span<const BatchRow> rows, const fs::path& results, const std::string& version) {
  const auto write = [&](const char* name, const std::string& text) {
    PendingFile file(results / name);
    write_bytes(text, file);
    file.commit();
  };
  write("summary.csv", summary_csv(rows));
  write("summary.json", summary_json(rows, version));
  write("summary.html", summary_html(rows, results, version));
}

}  // namespace aerate::batch
