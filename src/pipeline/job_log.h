#pragma once

#include <chrono>
#include <string>
#include <string_view>
#include <vector>

#include "core/monitor.h"
#include "pipeline/report.h"

namespace aerate {

// A monitor that passes everything on and remembers what belongs in the report: the stages with their time
// and memory, and the notices.
class JobLog final : public Monitor {
 public:
  explicit JobLog(Monitor& inner) : inner_(inner) {}

  void stage(std::string_view name) override;
  void progress(double fraction) override { inner_.progress(fraction); }
  void notice(std::string_view text) override;
  void check_interrupted() override { inner_.check_interrupted(); }
  void temporary_file_made(const std::filesystem::path& path) override { inner_.temporary_file_made(path); }
  void temporary_file_gone(const std::filesystem::path& path) override { inner_.temporary_file_gone(path); }

  // Ends the current stage. The stages so far, in order.
  std::vector<StageCost> finish();
  const std::vector<std::string>& notices() const { return notices_; }

 private:
  using Clock = std::chrono::steady_clock;

  void end_stage();

  Monitor& inner_;
  std::vector<StageCost> stages_;
  std::vector<std::string> notices_;
  std::string current_;
  Clock::time_point begin_;
};

// The end of a job: `commit` makes its files appear, and the report gets what the log has.
template <typename Report, typename Commit>
void end_job(JobLog& log, Report& report, const Commit& commit) {
  log.check_interrupted();  // the last time that nothing is left behind
  commit();
  report.stages = log.finish();
  report.notices = log.notices();
}

}  // namespace aerate
