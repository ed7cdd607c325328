#include "pipeline/job_log.h"

#include "pipeline/memory.h"

namespace aerate {

void JobLog::stage(std::string_view name) {
  if (name == current_) return;
  end_stage();
  current_ = name;
  begin_ = Clock::now();
  inner_.stage(name);
}

void JobLog::notice(std::string_view text) {
  notices_.emplace_back(text);
  inner_.notice(text);
}

std::vector<StageCost> JobLog::finish() {
  end_stage();
  return stages_;
}

void JobLog::end_stage() {
  if (current_.empty()) return;
  const std::chrono::duration<double> elapsed = Clock::now() - begin_;
  stages_.push_back({current_, elapsed.count(), peak_memory_bytes()});
  current_.clear();
}

}  // namespace aerate
