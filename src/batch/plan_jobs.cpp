#include "batch/plan_jobs.h"

#include <algorithm>
#include <cctype>
#include <chrono>
#include <fmt/format.h>
#include <mutex>
#include <optional>
#include <set>
#include <string_view>
#include <system_error>
#include <tbb/parallel_for.h>
#include <utility>

#include "batch/digest.h"
#include "batch/name_template.h"
#include "core/error.h"

namespace aerate::batch {
namespace {

namespace fs = std::filesystem;

// These change no byte of a result.
constexpr std::string_view kWithoutEffect[] = {"--device="};

// A result of this stem at the top would have files where the summary has its own.
constexpr const char* kSummaryStem = "summary";

bool has_effect(const std::string& argument) {
  return std::ranges::none_of(kWithoutEffect,
                              [&](std::string_view option) { return argument.starts_with(option); });
}

std::string usual_pattern(const std::string& ending) {
  return "{name}-hollow" + ending;
}

void set_fault(PlannedJob& job, const Error& error) {
  job.fault = error.hint().empty() ? error.what() : fmt::format("{} ({})", error.what(), error.hint());
  job.fault_code = static_cast<int>(error.code());
}

JobPaths paths_of(const fs::path& result, const PlanRequest& request) {
  const fs::path stem = result.parent_path() / result.stem();
  const auto beside = [&](const char* ending) { return fs::path(stem.string() + ending); };
  JobPaths paths{.result = result, .report = beside(".json"), .log = beside(".txt")};
  if (request.pictures) paths.picture = beside(".png");
  if (request.pages) paths.page = beside(".html");
  if (request.plugs) paths.plugs = beside(("-plugs" + result.extension().string()).c_str());
  return paths;
}

// What options come to, once for all jobs that have the same.
class UnderstoodOptions {
 public:
  explicit UnderstoodOptions(const Understand& understand) : understand_(understand) {}

  const Understood& of(const std::vector<std::string>& arguments) {
    const auto found = known_.find(arguments);
    if (found != known_.end()) return found->second;
    return known_.emplace(arguments, understand_(arguments)).first->second;
  }

 private:
  const Understand& understand_;
  std::map<std::vector<std::string>, Understood> known_;
};

PlannedJob named_job(const FoundModel& found, std::size_t number, const PlanRequest& request,
                     std::span<const OptionRule> rules, UnderstoodOptions& understood) {
  PlannedJob job{.number = number, .model = found.model, .origin = found.origin};
  if (!found.fault.empty()) throw UsageError(found.fault);
  job.arguments = arguments_of(merged(rules, request.options, found.options));
  const Understood& meaning = understood.of(job.arguments);
  if (found.output.empty()) {
    const fs::path folder = fs::absolute(found.model).lexically_normal().parent_path();
    const std::string pattern = request.name.empty() ? usual_pattern(meaning.ending) : request.name;
    job.name = found.sub_folder / name_from(pattern, {.name = found.model.stem().string(),
                                                      .folder = folder.filename().string(),
                                                      .process = meaning.process,
                                                      .number = number});
  } else {
    job.name = require_inside(found.output);
  }
  if (job.name.parent_path().empty() && job.name.stem() == kSummaryStem)
    throw UsageError(fmt::format("{}: the summary has this name", job.name.string()), "give another one");
  job.paths = paths_of(request.results / job.name, request);
  return job;
}

// Names without their endings: a result's report and picture have the same.
void find_names_that_are_shared(std::vector<PlannedJob>& jobs) {
  std::map<fs::path, std::vector<PlannedJob*>> by_stem;
  for (PlannedJob& job : jobs)
    if (!job.name.empty()) by_stem[job.name.parent_path() / job.name.stem()].push_back(&job);
  for (const auto& [stem, sharing] : by_stem) {
    if (sharing.size() < 2) continue;
    for (PlannedJob* const job : sharing) {
      const PlannedJob* const other = sharing[sharing.front() == job ? 1 : 0];
      set_fault(*job, UsageError(
                          fmt::format("its result would be {}, as that of {}", job->name.string(),
                                      other->model.string()),
                          "tell them apart with --name and {folder} or {n}, or with 'output' in a manifest"));
    }
  }
}

void find_results_that_are_models(std::vector<PlannedJob>& jobs) {
  std::set<fs::path> models;
  std::error_code ignored;
  for (const PlannedJob& job : jobs) models.insert(fs::weakly_canonical(job.model, ignored));
  for (PlannedJob& job : jobs)
    if (job.fault.empty() && models.contains(fs::weakly_canonical(job.paths.result, ignored)))
      set_fault(job,
                UsageError(fmt::format("{}: the result would replace a model", job.paths.result.string()),
                           "give another folder with -o, or another --name"));
}

// The values that are names of files.
std::vector<fs::path> files_of(const std::vector<std::string>& arguments, const Understood& meaning) {
  std::vector<fs::path> files = meaning.files;
  for (const std::string& argument : arguments) {
    const std::size_t sign = argument.find('=');
    std::error_code ignored;
    if (sign == std::string::npos) continue;
    fs::path value = argument.substr(sign + 1);
    if (fs::is_regular_file(value, ignored)) files.push_back(std::move(value));
  }
  return files;
}

// Digests of files that many jobs read.
class SharedDigests {
 public:
  std::string of(const fs::path& path) {
    const std::scoped_lock lock(mutex_);
    std::string& known = known_[path];
    if (known.empty()) known = digest_of_file(path);
    return known;
  }

 private:
  std::mutex mutex_;
  std::map<fs::path, std::string> known_;
};

// A text that differs wherever one of its parts does.
void append_part(std::string& text, std::string_view part) {
  text += fmt::format("{}:", part.size());
  text += part;
}

std::string key_of(const PlannedJob& job, const PlanRequest& request, const std::vector<fs::path>& files,
                   SharedDigests& shared) {
  std::string text;
  append_part(text, request.version);
  append_part(text, digest_of_file(job.model));
  append_part(text, job.paths.result.extension().string());
  for (const std::string& argument : job.arguments)
    if (has_effect(argument)) append_part(text, argument);
  for (const fs::path& file : files) append_part(text, shared.of(file));
  for (const bool is_made : {request.pictures, request.pages, request.plugs})
    append_part(text, is_made ? "1" : "0");
  return digest_of(text);
}

}  // namespace

JobEstimate estimate_of_file(const fs::path& model, double bytes, bool has_picture) {
  // Bytes a triangle: binary STL has 50, text about 4 times and packages about a fifth of that.
  std::string ending = model.extension().string();
  std::ranges::transform(ending, ending.begin(),
                         [](unsigned char byte) { return static_cast<char>(std::tolower(byte)); });
  static const std::map<std::string, double> kBytesPerTriangle{
      {".3mf", 10}, {".obj", 25}, {".off", 25}, {".ply", 20}, {".glb", 20}, {".gltf", 20}, {".3ds", 20}};
  const auto found = kBytesPerTriangle.find(ending);
  JobEstimate estimate;
  estimate.triangles = bytes / (found == kBytesPerTriangle.end() ? 50 : found->second);
  // Set by hand from a few jobs on one thread, rather too much than too little.
  constexpr double kBytesAlways = 120e6, kBytesEach = 450, kSecondsAlways = 0.3, kSecondsEach = 5e-6;
  constexpr double kBytesOfPicture = 60e6, kSecondsOfPicture = 0.5;
  estimate.memory_bytes =
      kBytesAlways + kBytesEach * estimate.triangles + (has_picture ? kBytesOfPicture : 0);
  estimate.seconds =
      kSecondsAlways + kSecondsEach * estimate.triangles + (has_picture ? kSecondsOfPicture : 0);
  return estimate;
}

FileState state_of(const fs::path& file) {
  const auto written = fs::last_write_time(file).time_since_epoch();
  return {file, fs::file_size(file), std::chrono::duration_cast<std::chrono::nanoseconds>(written).count()};
}

std::optional<fs::path> changed_file(const PlannedJob& job) {
  for (const FileState& planned : job.reads) {
    try {
      const FileState now = state_of(planned.path);
      if (now.bytes != planned.bytes || now.written_ns != planned.written_ns) return planned.path;
    } catch (const fs::filesystem_error&) {
      return planned.path;
    }
  }
  return std::nullopt;
}

std::vector<fs::path> JobPaths::all() const {
  std::vector<fs::path> paths;
  for (const fs::path* path : {&result, &report, &log, &picture, &page, &plugs})
    if (!path->empty()) paths.push_back(*path);
  return paths;
}

std::vector<PlannedJob> plan_jobs(const std::vector<FoundModel>& models, const PlanRequest& request,
                                  std::span<const OptionRule> rules, const Understand& understand,
                                  Monitor& monitor) {
  static_cast<void>(name_from(request.name.empty() ? "{name}" : request.name, {"a", "b", "c", 1}));
  UnderstoodOptions understood(understand);
  std::vector<PlannedJob> jobs;
  jobs.reserve(models.size());
  for (const FoundModel& found : models) {
    monitor.check_interrupted();
    const std::size_t number = jobs.size() + 1;
    try {
      jobs.push_back(named_job(found, number, request, rules, understood));
    } catch (const Error& error) {
      jobs.push_back({.number = number, .model = found.model, .origin = found.origin});
      set_fault(jobs.back(), error);
    }
  }
  find_names_that_are_shared(jobs);
  find_results_that_are_models(jobs);
  std::vector<const Understood*> meanings(jobs.size());
  for (std::size_t i = 0; i < jobs.size(); ++i)
    if (jobs[i].fault.empty()) meanings[i] = &understood.of(jobs[i].arguments);
  SharedDigests shared;
  tbb::parallel_for(std::size_t{0}, jobs.size(), [&](std::size_t i) {
    PlannedJob& job = jobs[i];
    if (!job.fault.empty()) return;
    try {
      // Before they are read for the key: what changes in between is found later.
      std::vector<fs::path> files = files_of(job.arguments, *meanings[i]);
      job.reads.push_back(state_of(job.model));
      for (const fs::path& file : files) job.reads.push_back(state_of(file));
      job.key = key_of(job, request, files, shared);
      job.model_bytes = static_cast<double>(job.reads.front().bytes);
      job.estimate = estimate_of_file(job.model, job.model_bytes, request.pictures || request.pages);
    } catch (const Error& error) {
      set_fault(job, error);
    } catch (const fs::filesystem_error& error) {
      set_fault(job, InputError(fmt::format("{}: {}", error.path1().string(), error.code().message())));
    }
  });
  monitor.check_interrupted();
  return jobs;
}

}  // namespace aerate::batch
