#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "batch/find_models.h"
#include "batch/given_options.h"
#include "core/monitor.h"

namespace aerate::batch {

// What the command line makes of a job's options.
struct Understood {
  std::string process;  // its name
  std::string ending;   // of a result that is not named otherwise, ".stl"
  std::vector<std::filesystem::path>
      files;  // that it reads beside the model and those that are values of options
};
// Throws UsageError as 'aerate hollow' does.
using Understand = std::function<Understood(const std::vector<std::string>& arguments)>;

struct JobEstimate {
  double triangles = 0, memory_bytes = 0, seconds = 0;
};

// From the file's size and kind alone: rough (docs/batch.md).
JobEstimate estimate_of_file(const std::filesystem::path& model, double bytes, bool has_picture);

// The files of a job. Those that were not asked for are empty.
struct JobPaths {
  std::filesystem::path result = {}, report = {}, log = {}, picture = {}, page = {}, plugs = {};

  std::vector<std::filesystem::path> all() const;  // those that are not empty
};

// A file as it was when the batch was planned.
struct FileState {
  std::filesystem::path path = {};
  std::uintmax_t bytes = 0;
  std::int64_t written_ns = 0;  // in the time of the file system
};
FileState state_of(const std::filesystem::path& file);  // throws std::filesystem::filesystem_error

struct PlannedJob {
  std::size_t number = 1;  // its place in the batch, from 1
  std::filesystem::path model = {};
  std::string origin = {};
  std::filesystem::path name = {};  // of the result below the folder of results
  JobPaths paths = {};
  std::vector<std::string> arguments = {};  // of 'aerate hollow' but for model, files and threads
  std::string key = {};                     // of all that the result depends on: model, options, version
  std::vector<FileState> reads = {};        // the files that the key is of
  double model_bytes = 0;
  JobEstimate estimate = {};
  std::string fault = {};  // why it cannot be begun, empty where it can
  int fault_code = 0;      // the exit status that stands for it
};

struct PlanRequest {
  std::filesystem::path results;     // the folder
  std::string name;                  // template, empty for the usual one
  std::vector<GivenOption> options;  // of all models
  bool pictures = false, pages = false, plugs = false;
  std::string version;  // of the program
};

// One that is not as it was when the job was planned, so that its key is not of what is there now; nothing if all are.
std::optional<std::filesystem::path> changed_file(const PlannedJob& job);

// A job for each model, in their order. What is wrong with one is its fault: a name that two share, an option that contradicts another, a
// file that cannot be read. Reads every model once, on all threads. Throws InterruptedError, and UsageError for a template that is none.
std::vector<PlannedJob> plan_jobs(const std::vector<FoundModel>& models, const PlanRequest& request,
                                  std::span<const OptionRule> rules, const Understand& understand,
                                  Monitor& monitor);

}  // namespace aerate::batch
