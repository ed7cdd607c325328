#include "files/three_mf_package.h"

#include <algorithm>
#include <array>
#include <exception>
#include <pugixml.hpp>
#include <zip.h>

#include "files/text_scan.h"
#include "files/three_mf.h"

namespace aerate {
namespace {

constexpr std::size_t kMostEntries = 20000;
constexpr std::uint64_t kMostUnpacked = std::uint64_t{4} << 30;  // bytes of one part
// Deflate makes a thousand bytes of one at most; models have been seen to make twenty.
constexpr std::uint64_t kSmallUnpacked = std::uint64_t{256} << 20, kMostPerPackedByte = 250;
constexpr std::uint64_t kMostDocument = std::uint64_t{16} << 20;  // bytes of a part that is held as a whole

constexpr std::string_view kModelRelation = "/3dmodel";  // how the type of the relation to it ends

struct Close {
  void operator()(zip_file_t* file) const { zip_fclose(file); }
};
using ArchivedFile = std::unique_ptr<zip_file_t, Close>;

zip_t* open_archive(const InputFile& file) {
  zip_error_t error;
  zip_error_init(&error);
  zip_source_t* const source = zip_source_buffer_create(file.data.get(), file.size, 0, &error);
  zip_t* const archive = source == nullptr ? nullptr : zip_open_from_source(source, ZIP_RDONLY, &error);
  const std::string reason = archive != nullptr ? std::string() : zip_error_strerror(&error);
  zip_error_fini(&error);
  if (archive != nullptr) return archive;
  zip_source_free(source);
  throw InputError(
      fmt::format("{}: a zip archive, as 3MF files are, but its table of contents at the end cannot "
                  "be read ({}): cut short or damaged",
                  file.name, reason),
      kCopyAgain);
}

// As names are looked for: no first slash, slashes that point forward, small letters.
std::string key_of(std::string_view name) {
  std::string key(name.substr(std::min(name.find_first_not_of("/\\"), name.size())));
  for (char& c : key) c = c == '\\' ? '/' : to_lower_ascii(c);
  return key;
}

// "My%20Model" is "My Model" in a relation.
std::string without_escapes(std::string_view target) {
  std::string name;
  while (!target.empty()) {
    unsigned char byte = 0;
    const char* const end = target.data() + std::min<std::size_t>(target.size(), 3);
    if (target.size() >= 3 && target[0] == '%' &&
        std::from_chars(target.data() + 1, end, byte, 16).ptr == end) {
      name += static_cast<char>(byte);
      target.remove_prefix(3);
    } else {
      name += target.front();
      target.remove_prefix(1);
    }
  }
  return name;
}

void require_modest(const zip_stat_t& facts, std::string_view part, const InputFile& file) {
  const bool is_bomb = facts.size > kSmallUnpacked && facts.size / kMostPerPackedByte > facts.comp_size;
  if (facts.size <= kMostUnpacked && !is_bomb) return;
  fail_to_read(file, "'{}' in the 3MF package would unpack from {} bytes to {}, which is too much", part,
               facts.comp_size, facts.size);
}

pugi::xml_document parsed(const std::string& text) {
  pugi::xml_document document;
  document.load_buffer(text.data(), text.size());
  return document;
}

}  // namespace

void ThreeMfPackage::Discard::operator()(zip* archive) const {
  zip_discard(archive);
}

ThreeMfPackage::ThreeMfPackage(const InputFile& file) : file_(file) {
  if (!file.text().starts_with("PK"))
    fail_to_read(file, "not a 3MF file, since it does not begin as a zip archive does");
  archive_.reset(open_archive(file));
  const auto count = static_cast<std::uint64_t>(zip_get_num_entries(archive_.get(), 0));
  if (count > kMostEntries) fail_to_read(file, "a zip archive of more than {} files", kMostEntries);
  for (std::uint64_t i = 0; i < count; ++i) {
    const char* const name = zip_get_name(archive_.get(), i, 0);
    if (name != nullptr) entries_.emplace(key_of(name), i);
  }
}

std::optional<std::uint64_t> ThreeMfPackage::find(std::string_view part) const {
  const auto found = entries_.find(key_of(part));
  return found == entries_.end() ? std::nullopt : std::optional(found->second);
}

void ThreeMfPackage::read(std::string_view part, const std::function<void(std::string_view)>& f) const {
  const auto fail = [&](const char* reason) {
    throw InputError(fmt::format("{}: '{}' in the 3MF package cannot be read: {}", file_.name, part, reason),
                     kCopyAgain);
  };
  const auto index = find(part);
  if (!index) fail("it is missing");
  zip_stat_t facts;
  zip_stat_init(&facts);
  if (zip_stat_index(archive_.get(), *index, 0, &facts) != 0) fail(zip_strerror(archive_.get()));
  require_modest(facts, part, file_);
  const ArchivedFile opened(zip_fopen_index(archive_.get(), *index, 0));
  if (!opened) fail(zip_strerror(archive_.get()));
  std::array<char, 1 << 16> block;
  std::exception_ptr refused;
  std::uint64_t total = 0;
  zip_int64_t count = 0;
  while ((count = zip_fread(opened.get(), block.data(), block.size())) > 0) {
    total += static_cast<std::uint64_t>(count);
    if (total > facts.size) fail("it is longer than the archive says");
    if (refused) continue;
    try {
      f(std::string_view(block.data(), static_cast<std::size_t>(count)));
    } catch (const InputError&) {
      refused = std::current_exception();
    }
  }
  if (count < 0) fail(zip_file_strerror(opened.get()));
  if (refused) std::rethrow_exception(refused);
}

std::string ThreeMfPackage::text_of(std::string_view part) const {
  std::string text;
  read(part, [&](std::string_view bytes) {
    if (text.size() + bytes.size() > kMostDocument)
      fail_to_read(file_, "'{}' in the 3MF package has more than {} bytes", part, kMostDocument);
    text += bytes;
  });
  return text;
}

// Empty if there is none, or if it names a part that is missing.
std::string ThreeMfPackage::model_by_relation() const {
  constexpr const char* kRelations = "_rels/.rels";
  if (!has(kRelations)) return {};
  const pugi::xml_document relations = parsed(text_of(kRelations));
  for (const pugi::xml_node relation : relations.child("Relationships").children("Relationship")) {
    if (!std::string_view(relation.attribute("Type").as_string()).ends_with(kModelRelation)) continue;
    std::string target = without_escapes(relation.attribute("Target").as_string());
    if (has(target)) return target;
  }
  return {};
}

std::string ThreeMfPackage::model() const {
  std::string named = model_by_relation();
  if (!named.empty()) return key_of(named) == key_of(kThreeMfModel) ? kThreeMfModel : named;
  if (has(kThreeMfModel)) return kThreeMfModel;
  std::vector<std::string> models;
  for (const auto& [key, index] : entries_)
    if (key.ends_with(".model")) models.emplace_back(zip_get_name(archive_.get(), index, 0));
  if (models.size() == 1) return models.front();
  if (models.empty()) {
    throw InputError(fmt::format("{}: not a 3MF file: a zip archive without a model ({} files)", file_.name,
                                 entries_.size()),
                     "3MF files hold one that ends in .model; unpack other archives first");
  }
  fail_to_read(file_, "{} models in the 3MF package, and nothing says which of them it is", models.size());
}

std::vector<OtherVolume> ThreeMfPackage::other_volumes(const std::vector<VolumeList>& lists) const {
  std::vector<OtherVolume> others;
  for (const VolumeList& list : lists) {
    if (!has(list.entry)) continue;
    const pugi::xml_document document = parsed(text_of(list.entry));
    for (const pugi::xml_node object : document.child("config").children("object")) {
      for (const pugi::xml_node volume : object.children(list.node)) {
        const auto kind = list.other_kind(volume);
        if (!kind) continue;
        others.push_back(
            {*kind, volume.find_child_by_attribute("metadata", "key", "name").attribute("value").as_string(),
             list.is_modifier(volume), list.is_own(volume), object.attribute("id").as_uint(),
             list.triangles(volume)});
      }
    }
  }
  return others;
}

}  // namespace aerate
