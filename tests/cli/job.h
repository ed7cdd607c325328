#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "core/mesh.h"
#include "tests/support/binary_stl.h"
#include "tests/support/files.h"
#include "tests/support/process.h"
#include "tests/support/shapes.h"
#include "tests/support/temporary_folder.h"

namespace aerate::test {

// The real executable, with an input folder and an output folder of its own.
class Job {
 public:
  Job() { std::filesystem::create_directory(outputs()); }

  std::filesystem::path outputs() const { return folder_.path() / "outputs"; }
  std::filesystem::path output(const std::string& name = "out.stl") const { return outputs() / name; }

  std::filesystem::path input(const std::string& name, std::string_view bytes) const {
    return folder_.write(name, bytes);
  }
  std::filesystem::path input(const std::string& name, const Mesh& mesh) const {
    return input(name, to_binary_stl(mesh));
  }
  std::filesystem::path folder() const { return folder_.path(); }

  // aerate hollow MODEL -o outputs/out.stl ARGUMENTS...
  std::vector<std::string> hollow(const std::filesystem::path& model,
                                  const std::vector<std::string>& arguments = {}) const {
    std::vector<std::string> command{AERATE_EXECUTABLE, "hollow", model, "-o", output()};
    command.insert(command.end(), arguments.begin(), arguments.end());
    return command;
  }

 private:
  TemporaryFolder folder_;
};

inline std::filesystem::path sample(const std::string& name) {
  return std::filesystem::path(AERATE_SAMPLES) / name;
}

// A block that takes voids quickly: 30 mm on a side.
inline Mesh block() {
  return make_box({0, 0, 0}, {30, 30, 30});
}

}  // namespace aerate::test
