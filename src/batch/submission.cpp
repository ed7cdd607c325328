#include "batch/submission.h"

#include <cstdint>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <system_error>
#include <utility>

#include "batch/job_state.h"
#include "core/error.h"
#include "files/output_file.h"
#include "printing/slicers/text_file.h"

namespace aerate::batch {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr const char* kSchema = "aerate.batch.submission";
constexpr int kVersion = 2;
constexpr const char *kLast = "last", *kOver = "over";
constexpr const char* kEnding = ".cbor";  // names of files are bytes, which JSON's text has no place for

// Below the folder of results, which others may know by another name.
Json json_of(const PlannedJob& job, const fs::path& results) {
  const auto below = [&](const fs::path& path) {
    return path.empty() ? std::string() : path.lexically_relative(results).string();
  };
  const JobPaths& paths = job.paths;
  Json reads = Json::array();
  for (const FileState& file : job.reads) reads.push_back({file.path.string(), file.bytes, file.written_ns});
  return {{"number", job.number},
          {"model", job.model.string()},
          {"origin", job.origin},
          {"name", job.name.string()},
          {"paths",
           {below(paths.result), below(paths.report), below(paths.log), below(paths.picture),
            below(paths.page), below(paths.plugs)}},
          {"arguments", job.arguments},
          {"key", job.key},
          {"reads", std::move(reads)},
          {"model_bytes", job.model_bytes},
          {"estimate", {job.estimate.triangles, job.estimate.memory_bytes, job.estimate.seconds}},
          {"fault", job.fault},
          {"fault_code", job.fault_code}};
}

PlannedJob job_of(const Json& json, const fs::path& results) {
  const auto path = [](const Json& text) { return fs::path(text.get<std::string>()); };
  const auto below = [&](const Json& text) {
    const fs::path name = path(text);
    return name.empty() ? fs::path() : results / name;
  };
  const Json &paths = json.at("paths"), &estimate = json.at("estimate");
  std::vector<FileState> reads;
  for (const Json& file : json.at("reads")) reads.push_back({path(file.at(0)), file.at(1), file.at(2)});
  return {.number = json.at("number"),
          .model = path(json.at("model")),
          .origin = json.at("origin"),
          .name = path(json.at("name")),
          .paths = {below(paths.at(0)), below(paths.at(1)), below(paths.at(2)), below(paths.at(3)),
                    below(paths.at(4)), below(paths.at(5))},
          .arguments = json.at("arguments").get<std::vector<std::string>>(),
          .key = json.at("key"),
          .reads = std::move(reads),
          .model_bytes = json.at("model_bytes"),
          .estimate = {estimate.at(0), estimate.at(1), estimate.at(2)},
          .fault = json.at("fault"),
          .fault_code = json.at("fault_code")};
}

Json json_of(const TaskArray& array) {
  Json tasks = Json::array();
  for (const ArrayTask& task : array.tasks) tasks.push_back(task.jobs);
  return {
      {"memory_bytes", array.memory_bytes}, {"seconds", array.seconds}, {"id", array.id}, {"tasks", tasks}};
}

TaskArray array_of(const Json& json, std::size_t jobs) {
  TaskArray array{
      .memory_bytes = json.at("memory_bytes"), .seconds = json.at("seconds"), .id = json.at("id")};
  for (const Json& task : json.at("tasks")) {
    array.tasks.push_back({task.get<std::vector<std::size_t>>()});
    for (const std::size_t job : array.tasks.back().jobs)
      if (job >= jobs) throw InputError("a task names a job that is none");
  }
  return array;
}

void write(const fs::path& path, std::string_view bytes) {
  PendingFile file(path);
  write_bytes(bytes, file);
  file.commit();
}

// Of a submission, as a file of one line has it; empty if there is none.
std::string name_in(const fs::path& file) {
  std::error_code ignored;
  return fs::exists(file, ignored) ? std::string(without_blanks(read_text(file))) : std::string();
}

}  // namespace

fs::path submissions_folder(const fs::path& results) {
  return state_folder(results) / "slurm";
}

fs::path submission_path(const fs::path& results, const std::string& name) {
  return submissions_folder(results) / (name + kEnding);
}

fs::path results_of(const fs::path& submission) {
  return submission.parent_path().parent_path().parent_path();
}

fs::path task_log(const fs::path& results, const TaskArray& array, std::size_t task) {
  return submissions_folder(results) / fmt::format("{}-{}.txt", array.id, task);
}

void keep_submission(const fs::path& results, const Submission& submission) {
  Json plan = Json::array(), arrays = Json::array();
  for (const PlannedJob& job : submission.plan) plan.push_back(json_of(job, results));
  for (const TaskArray& array : submission.arrays) arrays.push_back(json_of(array));
  const Json json{{"schema", kSchema},
                  {"schema_version", kVersion},
                  {"name", submission.name},
                  {"version", submission.version},
                  {"working_folder", submission.working_folder.string()},
                  {"threads", submission.threads},
                  {"plan", std::move(plan)},
                  {"arrays", std::move(arrays)}};
  const std::vector<std::uint8_t> bytes = Json::to_cbor(json);
  write(submission_path(results, submission.name),
        {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  write(submissions_folder(results) / kLast, submission.name + "\n");
}

Submission read_submission(const fs::path& file) {
  const fs::path results = results_of(file);
  try {
    const Json json = Json::from_cbor(read_text(file));
    if (json.at("schema") != kSchema || json.at("schema_version") != kVersion)
      throw InputError(file.string() + ": is of another version of the program");
    Submission submission{.name = json.at("name"),
                          .version = json.at("version"),
                          .working_folder = json.at("working_folder").get<std::string>(),
                          .threads = json.at("threads")};
    for (const Json& job : json.at("plan")) submission.plan.push_back(job_of(job, results));
    for (const Json& array : json.at("arrays"))
      submission.arrays.push_back(array_of(array, submission.plan.size()));
    return submission;
  } catch (const Json::exception&) {
    throw InputError(file.string() + ": says nothing of what was handed to a cluster");
  }
}

std::optional<Submission> last_submission(const fs::path& results) {
  const std::string name = name_in(submissions_folder(results) / kLast);
  std::error_code ignored;
  // A file that is gone was being removed.
  if (name.empty() || !fs::exists(submission_path(results, name), ignored)) return std::nullopt;
  Submission submission = read_submission(submission_path(results, name));
  submission.is_over = name_in(submissions_folder(results) / kOver) == name;
  return submission;
}

void mark_submission_over(const fs::path& results, const Submission& submission) {
  try {
    write(submissions_folder(results) / kOver, submission.name + "\n");
  } catch (const FailureError&) {
    // A full disk: the cluster is asked again then.
  }
}

void clear_submissions(const fs::path& results) {
  std::error_code error;
  fs::remove(submissions_folder(results) / kLast, error);  // first: without it nothing of the rest counts
  fs::remove_all(submissions_folder(results), error);
  if (!error) fs::create_directories(submissions_folder(results), error);
  if (error) throw FailureError(fmt::format("{}: {}", submissions_folder(results).string(), error.message()));
}

}  // namespace aerate::batch
