#include "files/sphere_table.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <string_view>

#include "core/error.h"

namespace aerate {
namespace {

constexpr std::array kKinds{SphereKind::lattice, SphereKind::interstice, SphereKind::tetrahedral,
                            SphereKind::replacement, SphereKind::adaptive};
constexpr std::string_view kCsvHeader = "x,y,z,radius,kind";
constexpr std::string_view kCsvHeaderWithoutKind = "x,y,z,radius";
constexpr const char* kSchema = "aerate.spheres";

// Where in a file something is, for messages.
struct Place {
  std::string file;
  std::string where;  // "line 3", "sphere 12"
};

[[noreturn]] void fail(const Place& place, const std::string& what) {
  throw InputError(fmt::format("{}: {}: {}", place.file, place.where, what),
                   "a list of spheres is what 'aerate pack' writes: x, y, z, radius in mm, and a kind");
}

double parse_number(std::string_view text, const Place& place) {
  while (!text.empty() && std::isspace(static_cast<unsigned char>(text.front())) != 0) text.remove_prefix(1);
  while (!text.empty() && std::isspace(static_cast<unsigned char>(text.back())) != 0) text.remove_suffix(1);
  double number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size())
    fail(place, fmt::format("'{}' is not a number", text));
  return number;
}

SphereKind parse_kind(std::string_view text, const Place& place) {
  while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
  for (const SphereKind kind : kKinds) {
    if (text == name_of(kind)) return kind;
  }
  fail(place, fmt::format("unknown kind of sphere '{}'", text));
}

// As PLY files have it: a place in the list of kinds.
SphereKind parse_kind_number(std::string_view text, const Place& place) {
  const double number = parse_number(text, place);
  for (std::size_t i = 0; i < kKinds.size(); ++i) {
    if (number == static_cast<double>(i)) return kKinds[i];
  }
  fail(place, fmt::format("unknown kind of sphere '{}'", text));
}

Sphere checked(const Sphere& sphere, const Place& place) {
  for (const double number : {sphere.centre.x, sphere.centre.y, sphere.centre.z, sphere.radius}) {
    if (!std::isfinite(number)) fail(place, "a number is not finite");
  }
  if (!(sphere.radius > 0)) fail(place, fmt::format("a radius of {} mm", sphere.radius));
  return sphere;
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

// The next line without what a line may end with elsewhere.
bool next_line(std::istream& in, std::string& line) {
  if (!std::getline(in, line)) return false;
  if (!line.empty() && line.back() == '\r') line.pop_back();
  return true;
}

std::vector<Sphere> read_csv(std::istream& in, const std::string& file) {
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";  // spreadsheets write one
  std::string line;
  next_line(in, line);
  if (line.starts_with(kByteOrderMark)) line.erase(0, kByteOrderMark.size());
  // Any other column, or another order, might mean other units or things than spheres.
  if (line != kCsvHeader && line != kCsvHeaderWithoutKind) {
    fail({file, "line 1"}, fmt::format("the header is not {}", kCsvHeader));
  }
  std::vector<Sphere> spheres;
  for (std::size_t number = 2; next_line(in, line); ++number) {
    if (line.empty()) continue;
    const Place place{file, fmt::format("line {}", number)};
    const std::vector<std::string_view> fields = split(line, ',');
    if (fields.size() != 4 && fields.size() != 5)
      fail(place, fmt::format("{} fields instead of 5", fields.size()));
    const Vec3d centre{parse_number(fields[0], place), parse_number(fields[1], place),
                       parse_number(fields[2], place)};
    const SphereKind kind = fields.size() == 5 ? parse_kind(fields[4], place) : SphereKind::adaptive;
    spheres.push_back(checked({centre, parse_number(fields[3], place), kind}, place));
  }
  return spheres;
}

std::vector<Sphere> read_json(std::istream& in, const std::string& file) {
  std::vector<Sphere> spheres;
  try {
    std::ostringstream text;
    text << in.rdbuf();
    const nlohmann::json json = nlohmann::json::parse(text.str());
    if (json.value("schema", "") != kSchema) fail({file, "schema"}, fmt::format("not '{}'", kSchema));
    if (json.value("unit", "") != "mm") fail({file, "unit"}, "not 'mm'");
    for (const nlohmann::json& entry : json.at("spheres")) {
      const Place place{file, fmt::format("sphere {}", spheres.size() + 1)};
      const SphereKind kind =
          entry.size() > 4 ? parse_kind(entry.at(4).get<std::string>(), place) : SphereKind::adaptive;
      const Vec3d centre{entry.at(0).get<double>(), entry.at(1).get<double>(), entry.at(2).get<double>()};
      spheres.push_back(checked({centre, entry.at(3).get<double>(), kind}, place));
    }
  } catch (const nlohmann::json::exception& error) {
    fail({file, fmt::format("sphere {}", spheres.size() + 1)}, error.what());
  }
  return spheres;
}

std::vector<Sphere> read_ply(std::istream& in, const std::string& file) {
  std::string line;
  std::optional<std::size_t> count;
  std::vector<std::string> properties;
  std::size_t number = 0;
  const auto place = [&] { return Place{file, fmt::format("line {}", number)}; };
  while (next_line(in, line)) {
    ++number;
    if (number == 1 && line != "ply") fail(place(), "not a PLY file");
    std::istringstream words(line);
    std::string word, type, name;
    words >> word;
    if (word == "format") {
      words >> type;
      if (type != "ascii") fail(place(), "only text PLY files hold spheres");
    } else if (word == "element") {
      std::size_t size = 0;
      words >> name >> size;
      if (name == "vertex") count = size;
    } else if (word == "property") {
      words >> type >> name;
      properties.push_back(name);
    } else if (word == "end_header") {
      break;
    }
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
  while (spheres.size() < *count && next_line(in, line)) {
    ++number;
    const std::vector<std::string_view> fields = split(line, ' ');
    if (fields.size() != properties.size()) {
      fail(place(), fmt::format("{} values instead of {}", fields.size(), properties.size()));
    }
    const SphereKind kind_of_sphere = parse_kind_number(fields[kind], place());
    const Vec3d centre{parse_number(fields[x], place()), parse_number(fields[y], place()),
                       parse_number(fields[z], place())};
    spheres.push_back(checked({centre, parse_number(fields[radius], place()), kind_of_sphere}, place()));
  }
  if (spheres.size() != *count) {
    fail(place(), fmt::format("the header promises {} spheres, the file has {}", *count, spheres.size()));
  }
  return spheres;
}

}  // namespace

const char* name_of(SphereKind kind) {
  switch (kind) {
    case SphereKind::lattice:
      return "lattice";
    case SphereKind::interstice:
      return "interstice";
    case SphereKind::tetrahedral:
      return "tetrahedral";
    case SphereKind::replacement:
      return "replacement";
    case SphereKind::adaptive:
      return "adaptive";
  }
  return "unknown";
}

SphereFormat sphere_format_of(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (extension == ".csv") return SphereFormat::csv;
  if (extension == ".json") return SphereFormat::json;
  if (extension == ".ply") return SphereFormat::ply;
  throw UsageError(fmt::format("{}: spheres cannot be written or read as {}", path.string(),
                               extension.empty() ? "a file without an ending" : extension),
                   "use a name that ends in .csv, .json or .ply");
}

std::string sphere_table(const Packing& packing, SphereFormat format) {
  std::string table;
  const auto out = std::back_inserter(table);
  const auto for_each = [&](auto line) {
    bool is_first = true;
    for (const Sphere& sphere : packing.spheres) {
      line(sphere, is_first);
      is_first = false;
    }
  };
  switch (format) {
    case SphereFormat::csv:
      table = "x,y,z,radius,kind\n";
      for_each([&](const Sphere& s, bool) {
        fmt::format_to(out, "{},{},{},{},{}\n", s.centre.x, s.centre.y, s.centre.z, s.radius,
                       name_of(s.kind));
      });
      break;
    case SphereFormat::json:
      table = fmt::format("{{\"schema\": \"{}\", \"schema_version\": 1, \"unit\": \"mm\", \"spheres\": [",
                          kSchema);
      for_each([&](const Sphere& s, bool is_first) {
        fmt::format_to(out, "{}\n[{}, {}, {}, {}, \"{}\"]", is_first ? "" : ",", s.centre.x, s.centre.y,
                       s.centre.z, s.radius, name_of(s.kind));
      });
      table += "\n]}\n";
      break;
    case SphereFormat::ply:
      table = fmt::format(
          "ply\nformat ascii 1.0\ncomment spheres, mm\nelement vertex {}\nproperty double x\nproperty double "
          "y\nproperty double z\nproperty double radius\nproperty uchar kind\nend_header\n",
          packing.spheres.size());
      for_each([&](const Sphere& s, bool) {
        fmt::format_to(out, "{} {} {} {} {}\n", s.centre.x, s.centre.y, s.centre.z, s.radius,
                       static_cast<unsigned>(s.kind));
      });
      break;
  }
  return table;
}

std::vector<Sphere> read_sphere_table(const std::filesystem::path& path) {
  const SphereFormat format = sphere_format_of(path);
  if (std::filesystem::is_directory(path)) throw InputError(path.string() + ": a directory, not a file");
  std::ifstream in(path);
  if (!in) throw InputError(path.string() + ": no such file, or it cannot be read");
  const std::string file = path.filename().string();
  std::vector<Sphere> spheres;
  switch (format) {
    case SphereFormat::csv:
      spheres = read_csv(in, file);
      break;
    case SphereFormat::json:
      spheres = read_json(in, file);
      break;
    case SphereFormat::ply:
      spheres = read_ply(in, file);
      break;
  }
  if (spheres.empty()) throw InputError(file + ": there are no spheres in it");
  return spheres;
}

}  // namespace aerate
