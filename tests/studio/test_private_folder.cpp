#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <string>
#include <sys/stat.h>

#include "core/error.h"
#include "studio/private_folder.h"
#include "tests/support/caught.h"
#include "tests/support/temporary_folder.h"

namespace aerate::studio {
namespace {

namespace fs = std::filesystem;

unsigned mode_of(const fs::path& path) {
  struct stat found {};
  return ::lstat(path.c_str(), &found) == 0 ? found.st_mode & 07777u : 0;
}

class PrivateFolderTest : public testing::Test {
 protected:
  PrivateFolderTest() { ::setenv("TMPDIR", parent_.path().c_str(), 1); }
  ~PrivateFolderTest() override { ::unsetenv("TMPDIR"); }

  const test::TemporaryFolder parent_;
};

TEST_F(PrivateFolderTest, IsForItsOwnerAloneAndGoneAfterwards) {
  fs::path path;
  {
    const mode_t mask = ::umask(0);
    const PrivateFolder folder;
    const NewFolder within(folder.path() / "m1");
    write_private_file(within.path() / "open.html", "x");
    ::umask(mask);
    path = folder.path();
    EXPECT_EQ(path.parent_path(), parent_.path());
    EXPECT_EQ(mode_of(path), 0700u);
    EXPECT_EQ(mode_of(within.path()), 0700u);
    EXPECT_EQ(mode_of(within.path() / "open.html"), 0600u);
    std::ofstream(path / "left") << "x";
  }
  EXPECT_FALSE(fs::exists(path));
  EXPECT_TRUE(fs::is_empty(parent_.path()));
}

// What a run that was killed left; a run that goes on keeps its own.
TEST_F(PrivateFolderTest, OfEarlierRunsAreRemovedUnlessTheyGoOn) {
  const PrivateFolder running;
  const fs::path left = parent_.path() / "aerate-studio-abcdef";
  fs::create_directory(left);
  std::ofstream(left / "model.stl") << "x";
  const fs::path link = parent_.path() / "aerate-studio-link";
  const test::TemporaryFolder elsewhere;
  const fs::path precious = elsewhere.write("precious", "x");
  fs::create_directory_symlink(elsewhere.path(), link);
  const PrivateFolder next;
  EXPECT_FALSE(fs::exists(left));
  EXPECT_TRUE(fs::exists(running.path()));
  EXPECT_TRUE(fs::exists(precious));
}

TEST_F(PrivateFolderTest, SaysWhatToSetWhereThereIsNone) {
  ::setenv("TMPDIR", (parent_.path() / "missing").c_str(), 1);
  EXPECT_TRUE(test::contains(test::message_of<FailureError>([] { const PrivateFolder folder; }), "TMPDIR"));
}

TEST_F(PrivateFolderTest, FilesAreNeverThoseOfSomebodyElse) {
  const test::TemporaryFolder elsewhere;
  const fs::path precious = elsewhere.write("precious", "x");
  fs::create_symlink(precious, parent_.path() / "open.html");
  EXPECT_NE(test::message_of<FailureError>([&] { write_private_file(parent_.path() / "open.html", "y"); }),
            "");
  EXPECT_EQ(fs::file_size(precious), 1u);
}

TEST_F(PrivateFolderTest, NewFoldersStayIfTheyAreKept) {
  const PrivateFolder folder;
  { const NewFolder gone(folder.path() / "gone"); }
  {
    NewFolder kept(folder.path() / "kept");
    kept.keep();
  }
  EXPECT_FALSE(fs::exists(folder.path() / "gone"));
  EXPECT_TRUE(fs::exists(folder.path() / "kept"));
}

}  // namespace
}  // namespace aerate::studio
