#include "cli/keep_solid_options.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <filesystem>

#include "cli/numbers.h"

namespace aerate::cli {
namespace {

// Beyond what is printed (mm), where single precision is coarse.
constexpr double kFarthest = 1e6;

// As parse_numbers, none of them farther out.
template <std::size_t kCount>
std::optional<std::array<double, kCount>> parse_near(std::string_view text) {
  const auto numbers = parse_numbers<kCount>(text);
  if (!numbers) return std::nullopt;
  const bool is_near = std::ranges::all_of(*numbers, [](double x) { return std::abs(x) <= kFarthest; });
  return is_near ? numbers : std::nullopt;
}

std::optional<RegionRequest> parse_box_region(const std::string& text, std::string_view numbers) {
  const auto box = parse_near<6>(numbers) ? parse_box(numbers) : std::nullopt;
  if (!box) return std::nullopt;
  const Vec3d size = box->upper - box->lower;
  if (!(size.x > 0 && size.y > 0 && size.z > 0)) return std::nullopt;
  return RegionRequest{text, *box};
}

std::optional<RegionRequest> parse_ball(const std::string& text, std::string_view numbers) {
  const auto n = parse_near<4>(numbers);
  if (!n || (*n)[3] <= 0) return std::nullopt;
  return RegionRequest{text, BallRegion{{(*n)[0], (*n)[1], (*n)[2]}, (*n)[3]}};
}

std::optional<RegionRequest> parse_cylinder(const std::string& text, std::string_view numbers) {
  const auto n = parse_near<7>(numbers);
  if (!n || (*n)[6] <= 0) return std::nullopt;
  const CylinderRegion region{{(*n)[0], (*n)[1], (*n)[2]}, {(*n)[3], (*n)[4], (*n)[5]}, (*n)[6]};
  if (!(length(region.end - region.start) > 0)) return std::nullopt;
  return RegionRequest{text, region};
}

struct Body {
  std::string_view prefix;
  std::optional<RegionRequest> (*parse)(const std::string& text, std::string_view numbers);
};
constexpr std::array kBodies{Body{"box:", parse_box_region}, Body{"sphere:", parse_ball},
                             Body{"cylinder:", parse_cylinder}};

}  // namespace

std::optional<RegionRequest> parse_region(const std::string& text) {
  for (const auto& [prefix, parse] : kBodies)
    if (text.starts_with(prefix)) return parse(text, std::string_view(text).substr(prefix.size()));
  if (text.empty()) return std::nullopt;
  return RegionRequest{text, NamedRegion(text)};
}

KeepSolidOptions::KeepSolidOptions(CLI::App& command) {
  command
      .add_option(
          "--keep-solid", texts_,
          "A region that stays solid, and that nothing comes nearer to than --wall: a mesh file, a "
          "modifier's name "
          "in a 3MF project, box:X0,Y0,Z0,X1,Y1,Z1, sphere:X,Y,Z,R or cylinder:X0,Y0,Z0,X1,Y1,Z1,R, in "
          "the model's coordinates (mm); may be repeated")
      ->check(
          parsed_by(parse_region,
                    "is no region: give a file, a modifier's name, box:x0,y0,z0,x1,y1,z1, sphere:x,y,z,r or "
                    "cylinder:x0,y0,z0,x1,y1,z1,r, in mm, no farther than 1000000 and none of its sizes 0"))
      ->type_name("REGION")
      ->allow_extra_args(false)  // or it would take the model
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
}

std::vector<RegionRequest> KeepSolidOptions::regions() const {
  std::vector<RegionRequest> regions;
  for (const std::string& text : texts_) regions.push_back(parse_region(text).value());
  return regions;
}

std::vector<NamedInput> KeepSolidOptions::inputs() const {
  std::vector<NamedInput> files;
  for (const RegionRequest& region : regions()) {
    std::error_code error;
    const auto* name = std::get_if<NamedRegion>(&region.shape);
    if (name != nullptr && std::filesystem::exists(*name, error))
      files.push_back({"region that stays solid", *name});
  }
  return files;
}

}  // namespace aerate::cli
