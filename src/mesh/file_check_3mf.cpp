#include <array>
#include <cstdint>
#include <fmt/format.h>
#include <memory>
#include <string_view>
#include <zip.h>

#include "core/error.h"
#include "mesh/file_check.h"

namespace aerate {
namespace {

constexpr const char* kCopyAgain = "export or copy the file again";

struct Discard {
  void operator()(zip_t* archive) const { zip_discard(archive); }
};
using Archive = std::unique_ptr<zip_t, Discard>;

struct Close {
  void operator()(zip_file_t* file) const { zip_fclose(file); }
};
using ArchivedFile = std::unique_ptr<zip_file_t, Close>;

Archive open_archive(const FileBytes& bytes, const std::string& name) {
  zip_error_t error;
  zip_error_init(&error);
  zip_source_t* const source = zip_source_buffer_create(bytes.data.get(), bytes.size, 0, &error);
  Archive archive(source == nullptr ? nullptr : zip_open_from_source(source, ZIP_RDONLY, &error));
  const std::string reason = archive ? std::string() : zip_error_strerror(&error);
  zip_error_fini(&error);
  if (archive) return archive;
  zip_source_free(source);
  throw InputError(
      fmt::format("{}: a zip archive, as 3MF files are, but its table of contents at the end cannot "
                  "be read ({}): cut short or damaged",
                  name, reason),
      kCopyAgain);
}

// The parts of a package that make up the model; damage to a picture in it does no harm.
bool is_needed(std::string_view entry) {
  return entry.ends_with(".model") || entry.ends_with(".rels") || entry == "[Content_Types].xml";
}

void read_through(zip_t* archive, std::uint64_t index, std::string_view entry, const std::string& name) {
  const auto fail = [&](const char* reason) {
    throw InputError(fmt::format("{}: '{}' in the 3MF package cannot be read: {}", name, entry, reason),
                     kCopyAgain);
  };
  const ArchivedFile file(zip_fopen_index(archive, index, 0));
  if (!file) fail(zip_strerror(archive));
  std::array<char, 1 << 16> block;
  zip_int64_t count = 0;
  do {
    count = zip_fread(file.get(), block.data(), block.size());
  } while (count > 0);
  if (count < 0) fail(zip_file_strerror(file.get()));
}

}  // namespace

void check_3mf(const FileBytes& bytes, const std::string& name) {
  if (!bytes.text().starts_with("PK"))
    throw InputError(fmt::format("{}: not a 3MF file, since it does not begin as a zip archive does", name));
  const Archive archive = open_archive(bytes, name);
  bool has_model = false;
  const auto count = static_cast<std::uint64_t>(zip_get_num_entries(archive.get(), 0));
  for (std::uint64_t i = 0; i < count; ++i) {
    const char* const found = zip_get_name(archive.get(), i, 0);
    const std::string_view entry = found == nullptr ? "" : found;
    if (!is_needed(entry)) continue;
    has_model = has_model || entry.ends_with(".model");
    read_through(archive.get(), i, entry, name);
  }
  if (!has_model) {
    throw InputError(fmt::format("{}: not a 3MF file: a zip archive without a model ({} files)", name, count),
                     "3MF files hold one that ends in .model; unpack other archives first");
  }
}

}  // namespace aerate
