#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "studio/refusal.h"

// What the studio says of what it keeps.

namespace aerate::studio {

// How much is taken. Beyond it, what was asked for is refused with the limit and what to do.
struct Bounds {
  std::uint64_t body_bytes = std::uint64_t{512} << 20;  // of a model's file
  std::size_t models = 16;
  std::size_t jobs = 32;       // that are kept, the finished ones among them
  std::size_t listeners = 16;  // to events
};

struct ModelRecord {
  std::string id;    // "m1"
  std::string name;  // as the user calls it
  std::uint64_t bytes = 0;
  std::string inspection = {};  // JSON, as 'aerate inspect --json' writes it
  bool is_usable = false;
  std::string use = {};
};

enum class JobState { waiting, running, done, failed, stopped };
const char* name_of(JobState state);
inline bool has_ended(JobState state) {
  return state != JobState::waiting && state != JobState::running;
}

// A result as a file to take away.
struct ResultFile {
  std::string form;  // "stl"
  std::string name;  // as the user is to call it
  std::uint64_t bytes = 0;
};

struct JobRecord {
  std::string id;  // "j1"
  std::string model, model_name;
  std::string options;  // JSON, as it was sent
  std::string command;  // the command line that does the same
  JobState state = JobState::waiting;
  std::size_t waiting_before = 0;
  std::string stage;
  std::optional<double> progress;  // of the stage
  std::vector<std::string> notices;
  std::optional<Refusal> error;
  std::vector<ResultFile> files;
  double seconds = 0;
};

// What is new since a moment; moments are counted.
struct Changes {
  std::uint64_t moment = 0;
  std::vector<ModelRecord> models = {};
  std::vector<JobRecord> jobs = {};
  std::vector<std::string> removed = {};  // ids of models and jobs
};

// A file that the studio keeps, and what it is called where it goes.
struct KeptFile {
  std::filesystem::path path;
  std::string name;
};

}  // namespace aerate::studio
