#include "cli/view_options.h"

#include <cmath>
#include <fmt/format.h>
#include <string_view>

#include "cli/model_options.h"
#include "cli/numbers.h"
#include "core/error.h"

namespace aerate::cli {

std::optional<PictureCut> parse_cut(const std::string& text) {
  if (text.empty() || text[0] < 'x' || text[0] > 'z') return std::nullopt;
  PictureCut cut{text[0] == 'x' ? CutAxis::x : text[0] == 'y' ? CutAxis::y : CutAxis::z, std::nullopt};
  if (text.size() == 1) return cut;
  std::string_view percent = std::string_view(text).substr(1);
  if (percent.front() != '=') return std::nullopt;
  percent.remove_prefix(1);
  if (percent.ends_with('%')) percent.remove_suffix(1);
  const auto number = parse_number(percent);
  if (!number || *number < 0 || *number > 100) return std::nullopt;
  cut.share = *number / 100;
  return cut;
}

std::optional<PictureSize> parse_picture_size(const std::string& text) {
  const std::size_t by = text.find('x');
  if (by == std::string::npos) return std::nullopt;
  const auto width = parse_number(std::string_view(text).substr(0, by));
  const auto height = parse_number(std::string_view(text).substr(by + 1));
  const auto is_side = [](const std::optional<double>& side) {
    return side && *side >= kLeastPictureSide && *side <= kMostPictureSide && std::floor(*side) == *side;
  };
  if (!is_side(width) || !is_side(height) || *width * *height > kMostPicturePixels) return std::nullopt;
  return PictureSize{static_cast<int>(*width), static_cast<int>(*height)};
}

ViewOptions::ViewOptions(CLI::App& command, const std::string& what) {
  command
      .add_option("--picture", picture_,
                  fmt::format("Also draw a picture of {}, cut open, with its figures (.png)", what))
      ->check(names_a_file())
      ->type_name("FILE");
  of_picture_.push_back(
      command
          .add_option(
              "--picture-cut", cut_,
              "Picture: the axis that it is cut across, and where, percent of the model from its low end; "
              "0 and 100: not cut (default where most void shows)")
          ->check(parsed_by(parse_cut, "is not x, y or z, alone or with a share of 0 to 100, as in y=40%"))
          ->type_name("AXIS[=SHARE%]"));
  of_picture_.push_back(
      command.add_option("--picture-size", size_, "Picture: its width and height in pixels")
          ->check(parsed_by(
              parse_picture_size,
              fmt::format("is not a width and a height of {} to {} pixels, as in 1000x800, {:g} million "
                          "pixels at most",
                          kLeastPictureSide, kMostPictureSide, kMostPicturePixels / 1e6)))
          ->type_name("WxH")
          ->capture_default_str());
  of_picture_.push_back(
      command
          .add_option(
              "--picture-colour", colour_,
              "Picture: what the colours of voids' walls say: their radius, or the thickness left to the "
              "model's surface")
          ->check(CLI::IsMember({"radius", "thickness"}))
          ->type_name("WHAT")
          ->capture_default_str());
  command
      .add_option(
          "--view", page_,
          fmt::format("Also make a page of {}, to turn and cut in a browser, with its figures: one file that "
                      "needs no network (.html)",
                      what))
      ->check(names_a_file())
      ->type_name("FILE");
}

ViewOutputs ViewOptions::outputs() const {
  ViewOutputs outputs;
  if (!page_.empty()) outputs.page = page_;
  if (picture_.empty()) {
    for (const CLI::Option* option : of_picture_)
      if (option->count() > 0)
        throw UsageError(option->get_name() + " without --picture has no effect", "add --picture FILE.png");
    return outputs;
  }
  PictureOutput& picture = outputs.picture.emplace();
  picture.path = picture_;
  if (const auto cut = parse_cut(cut_)) {
    picture.request.axis = cut->axis;
    picture.request.share = cut->share;
  }
  const PictureSize size = parse_picture_size(size_).value();
  picture.request.width = size.width;
  picture.request.height = size.height;
  if (colour_ == "thickness") picture.request.colour = PictureColour::thickness;
  return outputs;
}

std::vector<std::filesystem::path> ViewOptions::files() const {
  std::vector<std::filesystem::path> files;
  if (!picture_.empty()) files.emplace_back(picture_);
  if (!page_.empty()) files.emplace_back(page_);
  return files;
}

}  // namespace aerate::cli
