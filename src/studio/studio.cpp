#include "studio/studio.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <exception>
#include <fmt/format.h>
#include <utility>

#include "core/error.h"
#include "core/monitor.h"
#include "pipeline/inspect_model.h"
#include "pipeline/scene_of.h"
#include "pipeline/thread_limit.h"
#include "printing/slicers/slicers.h"
#include "studio/run_plan.h"
#include "view/page.h"

namespace aerate::studio {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

// What went is told to those who listen, who are seldom so far behind.
constexpr std::size_t kMostRemoved = 1000;

std::string in_megabytes(std::uint64_t bytes) {
  return fmt::format("{:.4g} MB", static_cast<double>(bytes) / 1e6);
}

Refused unknown(const char* what, const std::string& id) {
  return Refused({404, fmt::format("there is no {} {:.40}", what, id), "it may have been removed"});
}

// Whether a job is asked for more than is done to a model unasked, so that it may use one that could not be used.
bool may_mend(const HollowOptions& options) {
  const bool is_as_read = !options.load.unit && options.load.scale == Vec3d{1, 1, 1};
  return options.surface != SurfaceMode::automatic || options.max_hole || options.weld || !is_as_read;
}

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

}  // namespace

struct Studio::Model {
  ModelRecord record;
  std::shared_ptr<const DepthSamples> depths;  // of a closed one that can be used
  fs::path folder, file;                       // the folder is gone with it
  std::uint64_t moment = 0;                    // of its last change

  ~Model() {
    std::error_code error;
    if (!folder.empty()) fs::remove_all(folder, error);
  }
};

struct Studio::Job {
  JobRecord record;
  Plan plan;
  fs::path folder, model_file;
  ShownPaths shown;
  std::atomic<bool> is_to_stop = false;
  Clock::time_point begin;
  std::uint64_t moment = 0;

  ~Job() {
    std::error_code error;
    if (!folder.empty()) fs::remove_all(folder, error);
  }
};

// Of an inspection, which ends with the studio.
class Studio::EndMonitor final : public Monitor {
 public:
  explicit EndMonitor(const Studio& studio) : studio_(studio) {}
  void check_interrupted() override {
    const std::lock_guard lock(studio_.mutex_);
    if (studio_.is_ending_) throw InterruptedError();
  }

 private:
  const Studio& studio_;
};

// Tells a job's record what the job is doing.
class Studio::JobMonitor final : public Monitor {
 public:
  JobMonitor(Studio& studio, Job& job) : studio_(studio), job_(job) {}

  void stage(std::string_view name) override {
    update([&](JobRecord& record) {
      record.stage = name;
      record.progress.reset();
    });
  }
  void progress(double fraction) override {
    const double share = std::clamp(fraction, 0.0, 1.0);
    const int percent = static_cast<int>(share * 100);
    if (percent == percent_) return;
    percent_ = percent;
    update([&](JobRecord& record) { record.progress = share; });
  }
  void notice(std::string_view text) override {
    update([&](JobRecord& record) { record.notices.push_back(job_.shown.in(std::string(text))); });
  }
  void check_interrupted() override {
    if (job_.is_to_stop) throw InterruptedError();
  }

 private:
  template <typename Change>
  void update(const Change& change) {
    const std::lock_guard lock(studio_.mutex_);
    change(job_.record);
    job_.record.seconds = seconds_since(job_.begin);
    studio_.changed(job_.moment);
  }

  Studio& studio_;
  Job& job_;
  int percent_ = -1;
};

const char* name_of(OptionKind kind) {
  switch (kind) {
    case OptionKind::number:
      return "number";
    case OptionKind::text:
      return "text";
    case OptionKind::choice:
      return "choice";
    case OptionKind::flag:
      return "flag";
    case OptionKind::list:
      return "list";
  }
  return "";
}

const char* name_of(JobState state) {
  switch (state) {
    case JobState::waiting:
      return "waiting";
    case JobState::running:
      return "running";
    case JobState::done:
      return "done";
    case JobState::failed:
      return "failed";
    case JobState::stopped:
      return "stopped";
  }
  return "";
}

Upload::Upload(std::string id, std::string name, const fs::path& parent, std::uint64_t most_bytes,
               std::shared_ptr<const void> ticket)
    : id_(std::move(id)),
      name_(std::move(name)),
      folder_(parent / id_),
      path_(folder_.path() / (kModelStem + ending_of_model(name_))),
      file_(std::in_place, path_),
      most_bytes_(most_bytes),
      ticket_(std::move(ticket)) {}

void Upload::write(std::string_view bytes) {
  if (bytes.size() > most_bytes_ - bytes_)
    throw Refused({413, fmt::format("{}: the file is larger than {}", name_, in_megabytes(most_bytes_)),
                   "start 'aerate studio' with a larger --max-upload"});
  bytes_ += bytes.size();
  try {
    file_->write(bytes);
  } catch (const FailureError&) {
    ShownPaths shown;
    shown.add(path_, name_);
    Refusal refusal = refusal_of(std::current_exception());
    refusal.what = shown.in(std::move(refusal.what));
    if (refusal.hint.empty())
      refusal.hint = "TMPDIR names the folder for temporary files; give one with more room";
    throw Refused(std::move(refusal));
  }
}

Studio::Studio(Lent lent, Bounds bounds, fs::path folder, std::optional<int> threads)
    : lent_(std::move(lent)), bounds_(bounds), folder_(std::move(folder)), threads_(threads), worker_([this] {
        work();
      }) {}

Studio::~Studio() {
  {
    const std::lock_guard lock(mutex_);
    is_ending_ = true;
    for (const auto& job : jobs_) job->is_to_stop = true;
  }
  work_to_do_.notify_all();
  worker_.join();
}

void Studio::changed(std::uint64_t& moment) {
  moment = ++moment_;
  changed_.notify_all();
}

const Studio::Model& Studio::model(const std::string& id) const {
  const auto found = std::ranges::find(models_, id, [](const auto& each) { return each->record.id; });
  if (found == models_.end()) throw unknown("model", id);
  return **found;
}

Studio::Job& Studio::job(const std::string& id) const {
  const auto found = std::ranges::find(jobs_, id, [](const auto& each) { return each->record.id; });
  if (found == jobs_.end()) throw unknown("job", id);
  return **found;
}

std::unique_ptr<Upload> Studio::begin_upload(std::string_view name) {
  std::string shown = shown_name(name);
  static_cast<void>(ending_of_model(shown));
  const std::lock_guard lock(mutex_);
  if (models_.size() + uploads_ >= bounds_.models)
    throw Refused({429, fmt::format("{} models are open, and no more are kept", bounds_.models),
                   "remove one that is no longer needed"});
  ++uploads_;
  const std::shared_ptr<const void> ticket(&uploads_, [](std::atomic<std::size_t>* count) { --*count; });
  return std::make_unique<Upload>(fmt::format("m{}", ++models_made_), std::move(shown), folder_,
                                  bounds_.body_bytes, ticket);
}

ModelRecord Studio::take(std::unique_ptr<Upload> upload) {
  upload->file_->close();
  auto made = std::make_unique<Model>();
  made->record = {.id = upload->id_, .name = upload->name_, .bytes = upload->bytes_};
  made->file = upload->path_;
  ShownPaths shown;
  shown.add(made->file, upload->name_);
  try {
    const std::lock_guard one_at_a_time(inspecting_);
    run_with_threads(threads_, [&] {
      InspectOptions options;
      options.model = made->file;
      options.load.volume_lists = volume_lists();
      EndMonitor monitor(*this);
      InspectedModel inspected = inspect_to_show(options, monitor);
      InspectReport& report = inspected.report;
      report.input.path = upload->name_;
      report.use = shown.in(std::move(report.use));
      for (std::string& notice : report.notices) notice = shown.in(std::move(notice));
      write_bytes(page_bytes(scene_of(inspected.mesh, report), "aerate " AERATE_VERSION),
                  fs::path(upload->folder_.path() / kSceneFile));
      made->record.inspection = lent_.inspection_json(report);
      if (inspected.refusal) {
        Refusal refusal = refusal_of(std::make_exception_ptr(*inspected.refusal));
        refusal.what = shown.in(std::move(refusal.what));
        refusal.hint = shown.in(std::move(refusal.hint));
        made->record.refusal = std::move(refusal);
      }
      made->record.use = report.use;
      const Inspection& inspection = report.input.inspection;
      if (!inspected.refusal && inspection.closed())
        made->depths =
            std::make_shared<DepthSamples>(sample_depths(inspected.mesh, std::abs(inspection.filled_volume)));
    });
  } catch (...) {
    Refusal refusal = refusal_of(std::current_exception());
    refusal.what = shown.in(std::move(refusal.what));
    throw Refused(std::move(refusal));
  }
  upload->folder_.keep();
  made->folder = upload->folder_.path();
  const std::lock_guard lock(mutex_);
  changed(made->moment);
  models_.push_back(std::move(made));
  return models_.back()->record;
}

void Studio::remove_model(const std::string& id) {
  const std::lock_guard lock(mutex_);
  static_cast<void>(model(id));
  for (const auto& each : jobs_)
    if (each->record.model == id && !has_ended(each->record.state))
      throw Refused({409, fmt::format("job {} needs this model", each->record.id), "stop it first"});
  for (const auto& each : jobs_)
    if (each->record.model == id) tell_removed(each->record.id);
  std::erase_if(jobs_, [&](const auto& each) { return each->record.model == id; });
  std::erase_if(models_, [&](const auto& each) { return each->record.id == id; });
  tell_removed(id);
}

void Studio::tell_removed(const std::string& id) {
  std::uint64_t moment = 0;
  changed(moment);
  if (removed_.size() == kMostRemoved) removed_.erase(removed_.begin());
  removed_.emplace_back(moment, id);
}

KeptFile Studio::scene_of_model(const std::string& id) const {
  const std::lock_guard lock(mutex_);
  const Model& found = model(id);
  return {found.folder / kSceneFile, found.record.name + ".scene"};
}

Studio::Outlook Studio::outlook(const std::string& id, const std::vector<GivenOption>& options) const {
  PlanRequest request;
  ModelRecord of;
  std::shared_ptr<const DepthSamples> depths;
  {
    const std::lock_guard lock(mutex_);
    const Model& found = model(id);
    of = found.record;
    request = {found.file, of.name, folder_ / kResultStem, options};
    depths = found.depths;
  }
  Outlook outlook{lent_.plan(request), std::nullopt};
  if (of.refusal && !may_mend(outlook.plan.forms.front().options)) throw Refused(*of.refusal);
  if (depths) outlook.estimate = estimate_job(*depths, outlook.plan.forms);
  return outlook;
}

JobRecord Studio::start_job(const std::string& model_id, const std::vector<GivenOption>& options,
                            const std::string& options_as_sent) {
  auto made = std::make_unique<Job>();
  const std::lock_guard lock(mutex_);
  const Model& of = model(model_id);
  if (jobs_.size() >= bounds_.jobs)
    throw Refused({429, fmt::format("{} jobs are kept, and no more", bounds_.jobs),
                   "remove one whose result is no longer needed"});
  const std::string id = fmt::format("j{}", jobs_made_ + 1);
  const fs::path path = folder_ / id;
  made->plan = lent_.plan({of.file, of.record.name, path / kResultStem, options});
  NewFolder folder(path);
  ++jobs_made_;
  JobRecord& record = made->record;
  record.id = id;
  record.model = model_id;
  record.model_name = of.record.name;
  record.options = options_as_sent;
  record.command = made->plan.command;
  made->model_file = of.file;
  made->shown.add(of.file, of.record.name);
  made->shown.add(made->plan.forms.front().options.output, made->plan.output_name);
  for (const char* form : {"stl", "3mf", "amf"})
    made->shown.add(result_in(path, form), name_of_result(of.record.name, fmt::format(".{}", form)));
  folder.keep();
  made->folder = path;
  changed(made->moment);
  jobs_.push_back(std::move(made));
  work_to_do_.notify_one();
  return record_of(*jobs_.back());
}

JobRecord Studio::stop_job(const std::string& id) {
  const std::lock_guard lock(mutex_);
  Job& found = job(id);
  found.is_to_stop = true;
  if (found.record.state == JobState::waiting) {
    found.record.state = JobState::stopped;
    changed(found.moment);
    jobs_moved_up();
  }
  return record_of(found);
}

void Studio::remove_job(const std::string& id) {
  const std::lock_guard lock(mutex_);
  if (job(id).record.state == JobState::running)
    throw Refused({409, fmt::format("job {} is running", id), "stop it first"});
  std::erase_if(jobs_, [&](const auto& each) { return each->record.id == id; });
  tell_removed(id);
  jobs_moved_up();
}

KeptFile Studio::file_of_job(const std::string& id, const char* file, const std::string& name_end) const {
  const std::lock_guard lock(mutex_);
  const Job& found = job(id);
  if (found.record.state != JobState::done)
    throw Refused({409, fmt::format("job {} is {}, and has no result", id, name_of(found.record.state)),
                   has_ended(found.record.state) ? "start another" : "wait for its end"});
  return {found.folder / file, name_of_result(found.record.model_name, name_end)};
}

KeptFile Studio::scene_of_job(const std::string& id) const {
  return file_of_job(id, kSceneFile, ".scene");
}

KeptFile Studio::report_of_job(const std::string& id) const {
  return file_of_job(id, kReportFile, ".json");
}

KeptFile Studio::report_text_of_job(const std::string& id) const {
  return file_of_job(id, kReportTextFile, ".txt");
}

KeptFile Studio::result_of_job(const std::string& id, const std::string& form) const {
  const KeptFile any = report_of_job(id);
  const std::lock_guard lock(mutex_);
  for (const ResultFile& file : job(id).record.files)
    if (file.form == form) return {result_in(any.path.parent_path(), file.form), file.name};
  throw Refused({404, fmt::format("job {} has no result in this form", id), "its 'files' say which it has"});
}

std::size_t Studio::ongoing_jobs_before(const Job& of) const {
  std::size_t count = 0;
  for (const auto& each : jobs_) {
    if (each.get() == &of) break;
    if (!has_ended(each->record.state)) ++count;
  }
  return count;
}

JobRecord Studio::record_of(const Job& of) const {
  JobRecord record = of.record;
  if (record.state == JobState::waiting) record.waiting_before = ongoing_jobs_before(of);
  return record;
}

std::vector<ModelRecord> Studio::models() const {
  return changes_after(0, {}).models;
}

std::vector<JobRecord> Studio::jobs() const {
  return changes_after(0, {}).jobs;
}

Changes Studio::changes_after(std::uint64_t moment, std::chrono::milliseconds patience) const {
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, patience, [&] { return moment_ > moment; });
  Changes changes{.moment = moment_};
  for (const auto& each : models_)
    if (each->moment > moment) changes.models.push_back(each->record);
  for (const auto& each : jobs_)
    if (each->moment > moment) changes.jobs.push_back(record_of(*each));
  if (moment > 0)
    for (const auto& [when, id] : removed_)
      if (when > moment) changes.removed.push_back(id);
  return changes;
}

// Those that wait have fewer before them.
void Studio::jobs_moved_up() {
  for (const auto& each : jobs_)
    if (each->record.state == JobState::waiting) changed(each->moment);
}

void Studio::work() {
  std::unique_lock lock(mutex_);
  while (true) {
    const auto next = [&] {
      return std::ranges::find(jobs_, JobState::waiting, [](const auto& each) { return each->record.state; });
    };
    work_to_do_.wait(lock, [&] { return is_ending_ || next() != jobs_.end(); });
    if (is_ending_) return;
    Job& job = **next();  // one that runs is not removed
    job.record.state = JobState::running;
    job.begin = Clock::now();
    changed(job.moment);
    jobs_moved_up();
    lock.unlock();
    run(job);
    lock.lock();
    jobs_moved_up();
  }
}

void Studio::run(Job& job) {
  JobMonitor monitor(*this, job);
  std::vector<ResultFile> files;
  std::optional<Refusal> error;
  try {
    run_with_threads(threads_, [&] {
      files = run_plan(job.plan, job.record.model_name, job.folder, job.shown, lent_, monitor);
    });
  } catch (...) {
    error = refusal_of(std::current_exception());
    error->what = job.shown.in(std::move(error->what));
    error->hint = job.shown.in(std::move(error->hint));
    std::error_code ignored;
    fs::remove_all(job.folder, ignored);
  }
  const std::lock_guard lock(mutex_);
  JobRecord& record = job.record;
  record.seconds = seconds_since(job.begin);
  record.stage.clear();
  record.progress.reset();
  record.files = std::move(files);
  const bool is_stopped = error && error->exit == static_cast<int>(ExitCode::interrupted);
  record.state = !error ? JobState::done : is_stopped ? JobState::stopped : JobState::failed;
  if (!is_stopped) record.error = std::move(error);
  changed(job.moment);
}

}  // namespace aerate::studio
