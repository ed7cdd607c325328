#pragma once

#include <cstdint>
#include <filesystem>
#include <string_view>

namespace aerate::studio {

// A folder for this run alone, in the folder for temporary files: nobody else may look into it, and it is gone with this object.
// One that an earlier run could not remove, because it was killed, is removed as well. Throws FailureError.
class PrivateFolder {
 public:
  PrivateFolder();
  ~PrivateFolder();
  PrivateFolder(const PrivateFolder&) = delete;
  PrivateFolder& operator=(const PrivateFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  int lock_ = -1;  // of the folder: who can take it knows that its maker is gone
};

// A folder in it, that is gone with this object unless it is kept.
class NewFolder {
 public:
  explicit NewFolder(std::filesystem::path path);
  ~NewFolder();
  NewFolder(const NewFolder&) = delete;
  NewFolder& operator=(const NewFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  void keep() { kept_ = true; }

 private:
  std::filesystem::path path_;
  bool kept_ = false;
};

// A new file that only its owner may read. Throws FailureError.
void write_private_file(const std::filesystem::path& path, std::string_view bytes);

}  // namespace aerate::studio
