#include "files/sphere_table.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <iterator>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>

#include "core/listed.h"
#include "files/grain_tables.h"
#include "files/text_scan.h"

namespace aerate {
namespace {

constexpr std::array kKindNames{"lattice", "interstice", "tetrahedral", "replacement", "adaptive"};
constexpr std::string_view kCsvHeader = "x,y,z,radius,kind";
constexpr std::string_view kCsvHeaderWithoutKind = "x,y,z,radius";
constexpr const char* kSchema = "aerate.spheres";

// Where in a file something is, for messages.
struct Place {
  const InputFile& file;
  std::string where;  // "line 3", "sphere 12"
};

Place line_of(const InputFile& file, const LineReader& lines) {
  return {file, fmt::format("line {}", lines.number())};
}

[[noreturn]] void fail(const Place& place, const std::string& what) {
  throw InputError(fmt::format("{}: {}: {}", place.file.name, place.where, what),
                   "a list of spheres is what 'aerate pack' writes: x, y, z, radius in mm, and a kind");
}

double parse_field(std::string_view text, const Place& place) {
  const std::string_view trimmed = take_token(text);
  const auto number = parse_number<double>(trimmed);
  if (!number || !take_token(text).empty()) fail(place, fmt::format("'{:.40}' is not a number", trimmed));
  return *number;
}

SphereKind parse_kind(std::string_view text, const Place& place) {
  while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
  const auto found = std::find(kKindNames.begin(), kKindNames.end(), text);
  if (found == kKindNames.end()) fail(place, fmt::format("unknown kind of sphere '{:.40}'", text));
  return static_cast<SphereKind>(found - kKindNames.begin());
}

// As PLY files have it: a place in the list of kinds.
SphereKind parse_kind_number(std::string_view text, const Place& place) {
  const double number = parse_field(text, place);
  for (std::size_t i = 0; i < kKindNames.size(); ++i) {
    if (number == static_cast<double>(i)) return static_cast<SphereKind>(i);
  }
  fail(place, fmt::format("unknown kind of sphere '{:.40}'", text));
}

Sphere checked(const Sphere& sphere, const Place& place) {
  for (const double number : {sphere.centre.x, sphere.centre.y, sphere.centre.z, sphere.radius}) {
    if (!std::isfinite(number)) fail(place, "a number is not finite");
  }
  if (!(sphere.radius > 0)) fail(place, fmt::format("a radius of {} mm", sphere.radius));
  return sphere;
}

// x, y, z, radius.
Sphere parse_sphere(const std::array<std::string_view, 4>& fields, SphereKind kind, const Place& place) {
  std::array<double, 4> numbers{};
  std::transform(fields.begin(), fields.end(), numbers.begin(),
                 [&](std::string_view field) { return parse_field(field, place); });
  return checked({{numbers[0], numbers[1], numbers[2]}, numbers[3], kind}, place);
}

std::vector<std::string_view> split(std::string_view line, char separator) {
  std::vector<std::string_view> fields;
  for (std::size_t start = 0;;) {
    const std::size_t end = line.find(separator, start);
    fields.push_back(line.substr(start, end - start));
    if (end == std::string_view::npos) return fields;
    start = end + 1;
  }
}

std::vector<Sphere> read_csv(const InputFile& file) {
  LineReader lines(file, file.text().starts_with(kUtf8Mark) ? kUtf8Mark.size() : 0);  // spreadsheets write it
  const auto header = lines.next();
  // Any other column, or another order, might mean other units or things than spheres.
  if (header != kCsvHeader && header != kCsvHeaderWithoutKind)
    fail({file, "line 1"}, fmt::format("the header is not {}", kCsvHeader));
  std::vector<Sphere> spheres;
  while (const auto line = lines.next()) {
    if (line->empty()) continue;
    const Place place = line_of(file, lines);
    const std::vector<std::string_view> fields = split(*line, ',');
    if (fields.size() != 4 && fields.size() != 5)
      fail(place, fmt::format("{} fields instead of 5", fields.size()));
    const SphereKind kind = fields.size() == 5 ? parse_kind(fields[4], place) : SphereKind::adaptive;
    spheres.push_back(parse_sphere({fields[0], fields[1], fields[2], fields[3]}, kind, place));
  }
  return spheres;
}

std::vector<Sphere> read_json(const InputFile& file) {
  std::vector<Sphere> spheres;
  const auto place = [&] { return Place{file, fmt::format("sphere {}", spheres.size() + 1)}; };
  try {
    const nlohmann::json json = nlohmann::json::parse(file.text());
    if (json.value("schema", "") != kSchema) fail({file, "schema"}, fmt::format("not '{}'", kSchema));
    if (json.value("unit", "") != "mm") fail({file, "unit"}, "not 'mm'");
    for (const nlohmann::json& entry : json.at("spheres")) {
      const SphereKind kind =
          entry.size() > 4 ? parse_kind(entry.at(4).get<std::string>(), place()) : SphereKind::adaptive;
      const Vec3d centre{entry.at(0).get<double>(), entry.at(1).get<double>(), entry.at(2).get<double>()};
      spheres.push_back(checked({centre, entry.at(3).get<double>(), kind}, place()));
    }
  } catch (const nlohmann::json::exception& error) {
    fail(place(), fmt::format("{:.200}", error.what()));
  }
  return spheres;
}

std::vector<Sphere> read_ply(const InputFile& file) {
  LineReader lines(file);
  std::optional<std::size_t> count;
  std::vector<std::string_view> properties;
  if (lines.next() != "ply") fail({file, "line 1"}, "not a PLY file");
  for (auto line = lines.next(); line && line != "end_header"; line = lines.next()) {
    const std::string_view keyword = take_token(*line), first = take_token(*line), second = take_token(*line);
    if (keyword == "format" && first != "ascii")
      fail(line_of(file, lines), "only text PLY files hold spheres");
    if (keyword == "element" && first == "vertex") count = parse_number<std::size_t>(second).value_or(0);
    if (keyword == "property") properties.push_back(second);
  }
  const auto column = [&](const char* name) {
    const auto found = std::find(properties.begin(), properties.end(), name);
    if (found == properties.end()) fail({file, "header"}, fmt::format("no property '{}'", name));
    return static_cast<std::size_t>(found - properties.begin());
  };
  if (!count) fail({file, "header"}, "no vertices");
  const std::size_t x = column("x"), y = column("y"), z = column("z"), radius = column("radius");
  const std::size_t kind = column("kind");
  std::vector<Sphere> spheres;
  while (spheres.size() < *count) {
    const auto line = lines.next();
    const Place place = line_of(file, lines);
    if (!line) {
      fail(place, fmt::format("the header promises {} spheres, the file has {}", *count, spheres.size()));
    }
    const std::vector<std::string_view> f = split(*line, ' ');
    if (f.size() != properties.size())
      fail(place, fmt::format("{} values instead of {}", f.size(), properties.size()));
    spheres.push_back(parse_sphere({f[x], f[y], f[z], f[radius]}, parse_kind_number(f[kind], place), place));
  }
  return spheres;
}

std::string write_csv(const std::vector<Sphere>& spheres, const Box3f& /*model*/) {
  std::string table = fmt::format("{}\n", kCsvHeader);
  for (const auto& [centre, radius, kind] : spheres) {
    fmt::format_to(std::back_inserter(table), "{},{},{},{},{}\n", centre.x, centre.y, centre.z, radius,
                   name_of(kind));
  }
  return table;
}

std::string write_json(const std::vector<Sphere>& spheres, const Box3f& /*model*/) {
  std::string table =
      fmt::format("{{\"schema\": \"{}\", \"schema_version\": 1, \"unit\": \"mm\", \"spheres\": [", kSchema);
  const char* separator = "";
  for (const auto& [centre, radius, kind] : spheres) {
    fmt::format_to(std::back_inserter(table), "{}\n[{}, {}, {}, {}, \"{}\"]", std::exchange(separator, ","),
                   centre.x, centre.y, centre.z, radius, name_of(kind));
  }
  return table + "\n]}\n";
}

std::string write_ply(const std::vector<Sphere>& spheres, const Box3f& /*model*/) {
  std::string table = fmt::format(
      "ply\nformat ascii 1.0\ncomment spheres, mm\nelement vertex {}\nproperty double x\nproperty double "
      "y\nproperty double z\nproperty double radius\nproperty uchar kind\nend_header\n",
      spheres.size());
  for (const auto& [centre, radius, kind] : spheres) {
    fmt::format_to(std::back_inserter(table), "{} {} {} {} {}\n", centre.x, centre.y, centre.z, radius,
                   static_cast<unsigned>(kind));
  }
  return table;
}

}  // namespace

constinit const SphereFormat SphereFormat::csv{".csv", "", write_csv, read_csv};
constinit const SphereFormat SphereFormat::json{".json", "", write_json, read_json};
constinit const SphereFormat SphereFormat::ply{".ply", "", write_ply, read_ply};
constinit const SphereFormat SphereFormat::vtk{".vtp", "ParaView", vtk_spheres, nullptr};
constinit const SphereFormat SphereFormat::lammps{".data", "LAMMPS", lammps_spheres, nullptr};
constinit const SphereFormat SphereFormat::yade{".txt", "YADE", yade_spheres, nullptr};

namespace {

constexpr std::array kFormats{&SphereFormat::csv, &SphereFormat::json,   &SphereFormat::ply,
                              &SphereFormat::vtk, &SphereFormat::lammps, &SphereFormat::yade};

// For sentences: ".csv, .json or .ply"
std::string endings_of(bool (*is_meant)(const SphereFormat& format)) {
  std::vector<std::string> endings;
  for (const SphereFormat* format : kFormats) {
    if (!is_meant(*format)) continue;
    const std::string_view program = format->program;
    endings.push_back(program.empty() ? format->ending : fmt::format("{} ({})", format->ending, program));
  }
  return listed(endings, "or");
}

std::string ending_in_words(const std::filesystem::path& path) {
  const std::string ending = ending_of(path);
  return ending.empty() ? "a file without an ending" : ending;
}

}  // namespace

const char* name_of(SphereKind kind) {
  return kKindNames[static_cast<std::size_t>(kind)];
}

std::optional<SphereFormat> find_sphere_format(const std::filesystem::path& path) {
  const std::string ending = ending_of(path);
  for (const SphereFormat* format : kFormats)
    if (ending == format->ending) return *format;
  return std::nullopt;
}

std::string endings_of_sphere_tables() {
  return endings_of([](const SphereFormat&) { return true; });
}

SphereFormat sphere_format_to_write(const std::filesystem::path& path) {
  if (const auto format = find_sphere_format(path)) return *format;
  throw UsageError(fmt::format("{}: spheres cannot be written as {}", path.string(), ending_in_words(path)),
                   fmt::format("use a name that ends in {}", endings_of_sphere_tables()));
}

std::string sphere_table(const Packing& packing, const SphereFormat& format, const Box3f& model) {
  return format.write(packing.spheres, model);
}

std::vector<Sphere> read_sphere_table(const std::filesystem::path& path) {
  const auto format = find_sphere_format(path);
  if (!format || format->read == nullptr)
    throw UsageError(fmt::format("{}: spheres cannot be read from {}", path.string(), ending_in_words(path)),
                     fmt::format("use a name that ends in {}",
                                 endings_of([](const SphereFormat& each) { return each.read != nullptr; })));
  InputFile file = read_file(path);
  file.name = path.filename().string();
  std::vector<Sphere> spheres = format->read(file);
  if (spheres.empty()) fail_to_read(file, "there are no spheres in it");
  return spheres;
}

}  // namespace aerate
