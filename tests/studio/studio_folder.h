#pragma once

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <thread>
#include <utility>

#include "cli/studio_plan.h"
#include "studio/studio.h"
#include "tests/support/binary_stl.h"
#include "tests/support/shapes.h"
#include "tests/support/temporary_folder.h"

namespace aerate::studio {

// A studio as the program has it, in a folder that a test looks into.
class StudioFolder {
 public:
  explicit StudioFolder(Bounds bounds = {})
      : studio_(std::make_unique<Studio>(cli::lent_to_studio(), bounds, folder_.path(), std::nullopt)) {}

  Studio& studio() { return *studio_; }
  const std::filesystem::path& path() const { return folder_.path(); }
  void end() { studio_.reset(); }

  std::size_t entries() const {
    const std::filesystem::directory_iterator all(folder_.path());
    return static_cast<std::size_t>(std::distance(begin(all), end_of(all)));
  }

  ModelRecord upload(const std::string& name, std::string_view bytes) {
    auto upload = studio_->begin_upload(name);
    upload->write(bytes);
    return studio_->take(std::move(upload));
  }
  // 30 mm on a side, which takes voids quickly.
  ModelRecord upload_block() {
    return upload("block.stl", test::to_binary_stl(test::make_box({0, 0, 0}, {30, 30, 30})));
  }

  JobRecord record(const std::string& id) {
    for (JobRecord& job : studio_->jobs())
      if (job.id == id) return std::move(job);
    throw std::runtime_error("no job " + id);
  }
  // Once it has ended, or is as far as asked for.
  JobRecord wait_for(const std::string& id, JobState state = JobState::done) {
    while (true) {
      JobRecord job = record(id);
      if (job.state == state || has_ended(job.state)) return job;
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
  }

 private:
  static std::filesystem::directory_iterator end_of(const std::filesystem::directory_iterator& all) {
    return std::filesystem::end(all);
  }

  const test::TemporaryFolder folder_;
  std::unique_ptr<Studio> studio_;
};

// A job that takes a while: many small spheres.
inline std::vector<GivenOption> long_job() {
  return {{"max-radius", {"0.8"}}, {"min-radius", {"0.3"}}, {"gap", {"0.3"}}, {"shape", {"spheres"}}};
}

}  // namespace aerate::studio
