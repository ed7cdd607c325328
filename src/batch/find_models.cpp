#include "batch/find_models.h"

#include <algorithm>
#include <fmt/format.h>
#include <system_error>
#include <utility>

#include "batch/manifest.h"
#include "core/error.h"
#include "files/formats.h"

namespace aerate::batch {
namespace {

namespace fs = std::filesystem;

bool is_hidden(const fs::path& path) {
  return path.filename().string().starts_with('.');
}

bool is_same(const fs::path& a, const fs::path& b) {
  std::error_code error;
  return fs::equivalent(a, b, error) && !error;
}

// Adds the models of a folder; what cannot be read in it is noticed.
class FolderSearch {
 public:
  FolderSearch(const Search& search, Monitor& monitor) : search_(search), monitor_(monitor) {}

  void add_from(const fs::path& folder, const fs::path& sub_folder) {
    std::error_code error;
    std::vector<fs::path> files, folders;
    for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
      if (is_hidden(entry->path())) continue;
      std::error_code ignored;
      if (entry->is_directory(ignored)) {
        if (!entry->is_symlink(ignored)) folders.push_back(entry->path());
      } else if (is_a_models_name(entry->path())) {
        files.push_back(entry->path());
      }
    }
    if (error) monitor_.notice(fmt::format("{}: cannot be searched: {}", folder.string(), error.message()));
    std::ranges::sort(files);
    for (fs::path& file : files) found_.push_back({.model = std::move(file), .sub_folder = sub_folder});
    if (!search_.is_recursive) return;
    std::ranges::sort(folders);
    for (const fs::path& each : folders)
      if (!is_same(each, search_.results)) add_from(each, sub_folder / each.filename());
  }

  std::vector<FoundModel> found() && { return std::move(found_); }

 private:
  const Search& search_;
  Monitor& monitor_;
  std::vector<FoundModel> found_;
};

std::vector<FoundModel> models_of_folder(const fs::path& folder, const Search& search, Monitor& monitor) {
  if (is_same(folder, search.results))
    throw UsageError(fmt::format("{}: results would be taken for models the next time", folder.string()),
                     "give another folder with -o, such as one inside of it");
  FolderSearch found(search, monitor);
  found.add_from(folder, {});
  return std::move(found).found();
}

std::vector<FoundModel> models_of_manifest(const fs::path& path, std::span<const OptionRule> rules) {
  std::vector<ManifestRow> rows = read_manifest(path, rules);
  std::vector<FoundModel> found;
  found.reserve(rows.size());
  for (ManifestRow& row : rows)
    found.push_back({.model = std::move(row.model),
                     .output = std::move(row.output),
                     .origin = fmt::format("{}: line {}", path.string(), row.line),
                     .options = std::move(row.options),
                     .fault = std::move(row.fault)});
  return found;
}

}  // namespace

std::vector<FoundModel> find_models(const Search& search, std::span<const OptionRule> rules,
                                    Monitor& monitor) {
  std::vector<FoundModel> all;
  std::string empty;
  for (const fs::path& place : search.places) {
    std::error_code ignored;
    std::vector<FoundModel> found;
    if (fs::is_directory(place, ignored)) {
      found = models_of_folder(place.has_filename() ? place : place.parent_path(), search, monitor);
    } else if (is_a_manifests_name(place)) {
      found = models_of_manifest(place, rules);
    } else {
      found.push_back({.model = place});
    }
    if (found.empty()) {
      empty = place.string();
      monitor.notice(fmt::format("{}: no models in it", empty));
    }
    std::ranges::move(found, std::back_inserter(all));
  }
  if (all.empty())
    throw InputError(fmt::format("{}: no models in it", empty),
                     search.is_recursive ? "models are " + names_that_are_read()
                                         : "--recursive looks in the folders below it too");
  return all;
}

}  // namespace aerate::batch
