#include "pipeline/view_files.h"

#include <filesystem>
#include <fmt/format.h>
#include <strings.h>

#include "core/error.h"
#include "view/page.h"
#include "view/picture.h"
#include "view/png_bytes.h"

namespace aerate {
namespace {

void require_ending(const std::filesystem::path& path, const char* ending, const char* what) {
  if (::strcasecmp(path.extension().c_str(), ending) == 0) return;
  throw UsageError(fmt::format("{}: {} are written as {}", path.string(), what, ending),
                   fmt::format("give a name that ends in {}", ending));
}

}  // namespace

ViewFiles::ViewFiles(const ViewOutputs& outputs, Monitor& monitor) : outputs_(outputs) {
  if (outputs.page) {
    require_page();
    require_ending(*outputs.page, ".html", "pages");
  }
  if (outputs.picture) require_ending(outputs.picture->path, ".png", "pictures");
  if (outputs.picture) picture_ = std::make_unique<AnnouncedFile>(outputs.picture->path, monitor);
  if (outputs.page) page_ = std::make_unique<AnnouncedFile>(*outputs.page, monitor);
}

void ViewFiles::write(const std::function<Scene()>& make_scene, Monitor& monitor) {
  if (!outputs_.are_asked_for()) return;
  monitor.stage(picture_ ? "picture" : "page");
  const Scene scene = make_scene();
  monitor.check_interrupted();
  if (picture_) {
    const Picture picture = draw_picture(scene, outputs_.picture->request, monitor);
    write_bytes(png_of(picture.image), picture_->file());
  }
  if (page_) {
    if (picture_) monitor.stage("page");
    write_bytes(page_of(scene, "aerate " AERATE_VERSION), page_->file());
  }
  monitor.check_interrupted();
}

void ViewFiles::commit_with(std::vector<PendingFile*> results) {
  std::vector<PendingFile*> all;
  if (picture_) all.push_back(&picture_->file());
  if (page_) all.push_back(&page_->file());
  all.insert(all.end(), results.begin(), results.end());
  commit_all(all);
}

}  // namespace aerate
