#pragma once

#include <filesystem>
#include <gtest/gtest.h>
#include <string>
#include <string_view>

#include "core/error.h"
#include "core/mesh.h"
#include "files/load.h"
#include "printing/slicers/slicers.h"
#include "tests/support/caught.h"
#include "tests/support/shapes.h"
#include "tests/support/temporary_folder.h"

namespace aerate::test {

// A box whose coordinates are no short decimal numbers.
inline Mesh odd_box() {
  return make_box({-0.1f, 1.0f / 3.0f, -7.7f}, {2.3f, 4.1f, 1e-7f});
}

class Load : public testing::Test {
 protected:
  std::filesystem::path write(const std::string& name, std::string_view content) const {
    return folder_.write(name, content);
  }
  LoadedModel load(const std::string& name, std::string_view content, const LoadOptions& options = {}) const {
    return load_model(write(name, content), options);
  }
  std::string input_error(const std::string& name, std::string_view content) const {
    const std::filesystem::path path = write(name, content);
    const std::string message =
        message_of<InputError>([&] { load_model(path, {.unit = {}, .volume_lists = volume_lists()}); });
    EXPECT_TRUE(contains(message, path.string()));
    return message;
  }

  TemporaryFolder folder_;
};

}  // namespace aerate::test
