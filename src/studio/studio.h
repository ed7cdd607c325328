#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "files/output_file.h"
#include "pipeline/estimate.h"
#include "studio/lent.h"
#include "studio/names.h"
#include "studio/private_folder.h"
#include "studio/records.h"

namespace aerate::studio {

// A model's file on its way in, counted while it comes. Gone with this object unless the studio has taken it.
class Upload {
 public:
  //   ticket: held for as long as it is there
  Upload(std::string id, std::string name, const std::filesystem::path& parent, std::uint64_t most_bytes,
         std::shared_ptr<const void> ticket);

  // Throws Refused (413) beyond the limit, FailureError if it cannot be written.
  void write(std::string_view bytes);

 private:
  friend class Studio;

  std::string id_, name_;
  NewFolder folder_;
  std::filesystem::path path_;
  std::optional<OutputFile> file_;
  std::uint64_t bytes_ = 0, most_bytes_;
  std::shared_ptr<const void> ticket_;
};

// All that a run of the studio keeps: models, and jobs, which a thread of its own does one after the other. Every function may be
// called from any thread, and returns a copy of what was so at that moment. Throws Refused for what cannot be done; 404: unknown id.
class Studio {
 public:
  //   folder: private, and there for as long as this object
  //   threads: of jobs; all of the machine's if not given
  Studio(Lent lent, Bounds bounds, std::filesystem::path folder, std::optional<int> threads);
  ~Studio();  // stops what is running
  Studio(const Studio&) = delete;
  Studio& operator=(const Studio&) = delete;

  const Lent& lent() const { return lent_; }
  const Bounds& bounds() const { return bounds_; }

  // `name` as it was sent. Throws Refused (429) for too many models, InputError for a name that is none of a model.
  std::unique_ptr<Upload> begin_upload(std::string_view name);
  // Inspects what came. Throws what load_model throws.
  ModelRecord take(std::unique_ptr<Upload> upload);
  void remove_model(const std::string& id);
  KeptFile scene_of_model(const std::string& id) const;

  // What a job would be, and come to where that can be told. Throws UsageError, and for a model that cannot be used what the job would
  // begin with.
  struct Outlook {
    Plan plan;
    std::optional<JobEstimate> estimate;  // absent for an open model, of which that cannot be told
  };
  Outlook outlook(const std::string& model, const std::vector<GivenOption>& options) const;

  //   options: the same as JSON, for whoever asks for the job later
  JobRecord start_job(const std::string& model, const std::vector<GivenOption>& options,
                      const std::string& options_as_sent);
  JobRecord stop_job(const std::string& id);
  void remove_job(const std::string& id);
  // Of a job that is done; throws Refused (409) for another.
  KeptFile scene_of_job(const std::string& id) const;
  KeptFile report_of_job(const std::string& id) const;
  KeptFile report_text_of_job(const std::string& id) const;
  KeptFile result_of_job(const std::string& id, const std::string& form) const;

  std::vector<ModelRecord> models() const;
  std::vector<JobRecord> jobs() const;

  // What is new after a moment, as soon as there is something, or nothing after `patience`. After moment 0: all that is there.
  Changes changes_after(std::uint64_t moment, std::chrono::milliseconds patience) const;

 private:
  struct Model;
  struct Job;
  class JobMonitor;

  const Model& model(const std::string& id) const;
  Job& job(const std::string& id) const;
  std::size_t ongoing_jobs_before(const Job& job) const;
  JobRecord record_of(const Job& job) const;
  KeptFile file_of_job(const std::string& id, const char* file, const std::string& name_end) const;
  void changed(std::uint64_t& moment);
  void tell_removed(const std::string& id);
  void jobs_moved_up();
  void work();
  void run(Job& job);

  const Lent lent_;
  const Bounds bounds_;
  const std::filesystem::path folder_;
  const std::optional<int> threads_;

  mutable std::mutex mutex_;  // of all below
  mutable std::condition_variable changed_;
  std::condition_variable work_to_do_;
  std::vector<std::unique_ptr<Model>> models_;  // in the order in which they came, as jobs
  std::vector<std::unique_ptr<Job>> jobs_;
  std::vector<std::pair<std::uint64_t, std::string>> removed_;  // when what went
  std::uint64_t moment_ = 0;
  std::size_t models_made_ = 0, jobs_made_ = 0;
  bool is_ending_ = false;

  std::atomic<std::size_t> uploads_ = 0;
  std::mutex inspecting_;  // one model at a time
  std::thread worker_;     // last: it uses all the rest
};

}  // namespace aerate::studio
