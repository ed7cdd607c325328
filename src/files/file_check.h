#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace aerate {

// The content of a file in memory. Writable: a check may rewrite text into the plainer form that the importer
// understands.
struct FileBytes {
  std::unique_ptr<char[]> data;
  std::size_t size = 0;

  std::string_view text() const { return {data.get(), size}; }
};

// Throws InputError if the file is missing, not a regular file, or empty.
void check_readable(const std::filesystem::path& path);

// Reads a whole file. Throws InputError as above, or with the system's reason.
FileBytes read_file(const std::filesystem::path& path);

// What a file says about itself, to be held against what the importer made of it.
struct FileFacts {
  std::optional<std::size_t> face_count;    // faces of any number of corners
  std::optional<std::size_t> vertex_count;  // vertices of an indexed format
};

// The importer is lenient: it reads past missing data with zeros, leaves out what it cannot use and trusts
// the counts of a header with memory. These look at the whole file first, and throw InputError saying what is
// wrong and where: truncated, counts that do not hold, indices out of range, not this format at all. `name`
// is the file's name for messages. O(bytes).
FileFacts check_stl(FileBytes& bytes, const std::string& name);
FileFacts check_obj(const FileBytes& bytes, const std::string& name);
FileFacts check_ply(const FileBytes& bytes, const std::string& name);
FileFacts check_off(FileBytes& bytes, const std::string& name);

// The same for a 3MF package: a whole zip archive that holds a model, with the checksums of what is needed of
// it. Takes out what the package says to have and has not.
void check_3mf(FileBytes& bytes, const std::string& name);

// Throws InputError for a slicer's project with volumes that are not part of the model.
void require_model_parts_only(const FileBytes& bytes, const std::string& name);

// The same for a binary STL file from its first bytes and its size alone, so that 50 bytes for each triangle
// are read once only, by the importer. Empty if a whole look is needed: another kind of file, or a wrong
// size.
std::optional<FileFacts> check_binary_stl(const std::filesystem::path& path);

}  // namespace aerate
