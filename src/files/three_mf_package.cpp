#include "files/three_mf_package.h"

#include <array>
#include <cstdint>
#include <memory>
#include <pugixml.hpp>
#include <sstream>
#include <string_view>
#include <vector>
#include <zip.h>

namespace aerate {
namespace {

constexpr const char* kRelations = "_rels/.rels";

struct Discard {
  void operator()(zip_t* archive) const { zip_discard(archive); }
};
using Archive = std::unique_ptr<zip_t, Discard>;

struct Close {
  void operator()(zip_file_t* file) const { zip_fclose(file); }
};
using ArchivedFile = std::unique_ptr<zip_file_t, Close>;

Archive open_archive(const InputFile& file) {
  zip_error_t error;
  zip_error_init(&error);
  zip_source_t* const source = zip_source_buffer_create(file.data.get(), file.size, 0, &error);
  Archive archive(source == nullptr ? nullptr : zip_open_from_source(source, ZIP_RDONLY, &error));
  const std::string reason = archive ? std::string() : zip_error_strerror(&error);
  zip_error_fini(&error);
  if (archive) return archive;
  zip_source_free(source);
  throw InputError(
      fmt::format("{}: a zip archive, as 3MF files are, but its table of contents at the end cannot "
                  "be read ({}): cut short or damaged",
                  file.name, reason),
      kCopyAgain);
}

// The parts of a package that make up the model; damage to a picture in it does no harm.
bool is_needed(std::string_view entry) {
  return entry.ends_with(".model") || entry.ends_with(".rels") || entry == "[Content_Types].xml";
}

// Calls f(bytes) for each block of an entry.
template <typename F>
void read_through(zip_t* archive, std::uint64_t index, std::string_view entry, const InputFile& package,
                  const F& f) {
  const auto fail = [&](const char* reason) {
    throw InputError(
        fmt::format("{}: '{}' in the 3MF package cannot be read: {}", package.name, entry, reason),
        kCopyAgain);
  };
  const ArchivedFile file(zip_fopen_index(archive, index, 0));
  if (!file) fail(zip_strerror(archive));
  std::array<char, 1 << 16> block;
  zip_int64_t count = 0;
  while ((count = zip_fread(file.get(), block.data(), block.size())) > 0)
    f(std::string_view(block.data(), static_cast<std::size_t>(count)));
  if (count < 0) fail(zip_file_strerror(file.get()));
}

// An entry as a document; empty if it is not there, or no XML: the importer says what it needs.
pugi::xml_document document_in(zip_t* archive, const char* entry, const InputFile& package) {
  pugi::xml_document document;
  const zip_int64_t index = zip_name_locate(archive, entry, 0);
  if (index < 0) return document;
  std::string text;
  read_through(archive, static_cast<std::uint64_t>(index), entry, package,
               [&](std::string_view bytes) { text += bytes; });
  document.load_buffer(text.data(), text.size());
  return document;
}

std::string text_of(const pugi::xml_document& document) {
  std::ostringstream stream;
  document.save(stream, "", pugi::format_raw, pugi::encoding_utf8);
  return std::move(stream).str();
}

// Puts another entry in place of one that the package has.
void replace_entry(InputFile& file, const char* entry, const std::string& content) {
  const auto require = [&](bool done) {
    if (!done) fail_to_read(file, "'{}' in the 3MF package cannot be mended", entry);
  };
  struct Free {
    void operator()(zip_source_t* source) const { zip_source_free(source); }
  };
  const std::unique_ptr<zip_source_t, Free> buffer(
      zip_source_buffer_create(file.data.get(), file.size, 0, nullptr));
  require(buffer != nullptr);
  zip_source_keep(buffer.get());
  Archive archive(zip_open_from_source(buffer.get(), 0, nullptr));
  if (!archive) zip_source_free(buffer.get());
  require(archive != nullptr);
  const zip_int64_t index = zip_name_locate(archive.get(), entry, 0);
  zip_source_t* const source = zip_source_buffer(archive.get(), content.data(), content.size(), 0);
  const bool replaced =
      index >= 0 && zip_file_replace(archive.get(), static_cast<zip_uint64_t>(index), source, 0) == 0;
  if (!replaced) zip_source_free(source);
  require(replaced && zip_close(archive.get()) == 0);
  static_cast<void>(archive.release());  // gone with closing it
  zip_stat_t facts;
  zip_stat_init(&facts);
  require(zip_source_stat(buffer.get(), &facts) == 0 && zip_source_open(buffer.get()) == 0);
  auto mended = std::make_unique_for_overwrite<char[]>(facts.size);
  const zip_int64_t count = zip_source_read(buffer.get(), mended.get(), facts.size);
  zip_source_close(buffer.get());
  require(count >= 0 && static_cast<std::size_t>(count) == facts.size);
  file.data = std::move(mended);
  file.size = facts.size;
}

// The package's relations without those to parts that are missing, if there are such: PrusaSlicer's command
// line names a thumbnail that it does not make, and lib3mf then refuses the whole.
std::string without_missing_parts(zip_t* archive, const InputFile& package) {
  pugi::xml_document relations = document_in(archive, kRelations, package);
  std::vector<pugi::xml_node> missing;
  for (const pugi::xml_node relation : relations.child("Relationships").children("Relationship")) {
    std::string_view target = relation.attribute("Target").as_string();
    if (target.starts_with('/')) target.remove_prefix(1);
    const bool external = std::string_view(relation.attribute("TargetMode").as_string()) == "External";
    if (!external && zip_name_locate(archive, std::string(target).c_str(), ZIP_FL_NOCASE) < 0)
      missing.push_back(relation);
  }
  if (missing.empty()) return {};
  for (const pugi::xml_node relation : missing) relations.child("Relationships").remove_child(relation);
  return text_of(relations);
}

}  // namespace

void check_3mf(InputFile& file) {
  if (!file.text().starts_with("PK"))
    fail_to_read(file, "not a 3MF file, since it does not begin as a zip archive does");
  const Archive archive = open_archive(file);
  bool has_model = false;
  const auto count = static_cast<std::uint64_t>(zip_get_num_entries(archive.get(), 0));
  for (std::uint64_t i = 0; i < count; ++i) {
    const char* const found = zip_get_name(archive.get(), i, 0);
    const std::string_view entry = found == nullptr ? "" : found;
    if (!is_needed(entry)) continue;
    has_model = has_model || entry.ends_with(".model");
    read_through(archive.get(), i, entry, file, [](std::string_view) {});
  }
  if (!has_model) {
    throw InputError(
        fmt::format("{}: not a 3MF file: a zip archive without a model ({} files)", file.name, count),
        "3MF files hold one that ends in .model; unpack other archives first");
  }
  const std::string relations = without_missing_parts(archive.get(), file);
  if (!relations.empty()) replace_entry(file, kRelations, relations);
}

void require_model_parts_only(const InputFile& file, const std::vector<VolumeList>& lists) {
  const Archive archive = open_archive(file);
  for (const VolumeList& list : lists) {
    const pugi::xml_document document = document_in(archive.get(), list.entry, file);
    for (const pugi::xml_node object : document.child("config").children("object")) {
      for (const pugi::xml_node volume : object.children(list.node)) {
        const auto kind = list.other_kind(volume);
        if (!kind) continue;
        throw InputError(
            fmt::format(
                "{}: a slicer's project with a volume that is not part of the model ({} '{}')", file.name,
                *kind,
                volume.find_child_by_attribute("metadata", "key", "name").attribute("value").as_string()),
            "take such volumes out, or export the model alone (in PrusaSlicer: File, Export, Export Plate as "
            "STL)");
      }
    }
  }
}

}  // namespace aerate
