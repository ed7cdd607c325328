#include "batch/job_state.h"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <csignal>
#include <fcntl.h>
#include <fmt/format.h>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <string_view>
#include <sys/file.h>
#include <system_error>
#include <thread>
#include <unistd.h>
#include <utility>

#include "batch/digest.h"
#include "core/error.h"
#include "files/output_file.h"

namespace aerate::batch {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr const char* kStateFolder = ".aerate-batch";
constexpr int kRecordVersion = 1;
constexpr const char* kPlugs = "plugs";

FailureError cannot_be_used(const fs::path& folder, const std::string& why) {
  return FailureError(fmt::format("{}: cannot be used for results: {}", folder.string(), why),
                      "give another folder with -o");
}

void make_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error || !fs::is_directory(folder, error))
    throw cannot_be_used(folder, error ? error.message() : "it is no folder");
}

// Until another batch ends, or what a killed one started.
int locked(const fs::path& folder, Use use) {
  const std::chrono::seconds longest(use == Use::alone ? 5 : 60);
  constexpr std::chrono::milliseconds kPause(20);
  const fs::path file = folder / "lock";
  const int lock = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (lock < 0) throw cannot_be_used(folder, std::generic_category().message(errno));
  const auto start = std::chrono::steady_clock::now();
  while (::flock(lock, (use == Use::alone ? LOCK_EX : LOCK_SH) | LOCK_NB) != 0) {
    const int error = errno;
    if (error == EINTR) continue;
    if (error != EWOULDBLOCK || std::chrono::steady_clock::now() - start > longest) {
      ::close(lock);
      if (error != EWOULDBLOCK) throw cannot_be_used(folder, std::generic_category().message(error));
      throw FailureError(fmt::format("{}: another batch is at work there", folder.parent_path().string()),
                         "wait for its end, or give another folder with -o");
    }
    std::this_thread::sleep_for(kPause);
  }
  return lock;
}

// What a result's temporary file begins with, as PendingFile names it.
std::string temporary_stem(const fs::path& target) {
  constexpr std::size_t kLongestStem = 128;
  return target.stem().string().substr(0, kLongestStem);
}

// ".STEM.aerate-PID-.." of one of these stems, and of a process that is gone.
bool is_left(const std::string& name, const std::set<std::string>& stems) {
  constexpr std::string_view kMark = ".aerate-";
  const std::size_t mark = name.rfind(kMark);
  if (!name.starts_with('.') || mark == std::string::npos || mark == 0) return false;
  if (!stems.contains(name.substr(1, mark - 1))) return false;
  int process = 0;
  const char* const digits = name.data() + mark + kMark.size();
  const auto [end, error] = std::from_chars(digits, name.data() + name.size(), process);
  return error == std::errc() && process > 0 && *end == '-' && ::kill(process, 0) != 0 && errno == ESRCH;
}

std::string stem_of_record(const PlannedJob& job) {
  constexpr std::size_t kDigits = 32;
  return digest_of((job.name.parent_path() / job.name.stem()).string()).substr(0, kDigits);
}

fs::path mark_of(const fs::path& results, const PlannedJob& job) {
  return state_folder(results) / (stem_of_record(job) + ".begun");
}

Outcome outcome_called(const std::string& name) {
  for (const Outcome outcome : {Outcome::done, Outcome::refused, Outcome::failed, Outcome::crashed})
    if (name == name_of(outcome)) return outcome;
  return Outcome::not_done;
}

std::optional<Json> json_in(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) return std::nullopt;
  Json json = Json::parse(file, nullptr, false);
  if (!json.is_object()) return std::nullopt;
  return json;
}

bool is_as_it_was_written(const fs::path& file, std::uintmax_t bytes) {
  std::error_code error;
  return fs::is_regular_file(file, error) && fs::file_size(file, error) == bytes && !error;
}

// What a record calls a file: by its ending, since all but the plugs have one stem.
std::string kind_of(const fs::path& file, const PlannedJob& job) {
  return file == job.paths.plugs ? kPlugs : file.extension().string();
}

}  // namespace

const char* name_of(Outcome outcome) {
  switch (outcome) {
    case Outcome::done:
      return "done";
    case Outcome::refused:
      return "refused";
    case Outcome::failed:
      return "failed";
    case Outcome::crashed:
      return "crashed";
    case Outcome::not_done:
      break;
  }
  return "not done";
}

ResultsFolder::ResultsFolder(fs::path results, const std::vector<PlannedJob>& jobs, Monitor& monitor, Use use)
    : results_(std::move(results)), jobs_(jobs), use_(use) {
  make_folder(state_folder(results_));
  monitor.check_interrupted();
  lock_ = locked(state_folder(results_), use);
  if (use == Use::alone) remove_left_files();
}

ResultsFolder::~ResultsFolder() {
  if (lock_ >= 0) ::close(lock_);
}

void ResultsFolder::remove_left_files() const {
  std::map<fs::path, std::set<std::string>> stems;
  for (const PlannedJob& job : jobs_) {
    if (!job.fault.empty()) continue;
    for (const fs::path& path : job.paths.all()) stems[path.parent_path()].insert(temporary_stem(path));
    const fs::path record = record_path(results_, job);
    stems[record.parent_path()].insert(temporary_stem(record));
  }
  if (use_ == Use::alone) stems[results_].insert("summary");  // which no task of a cluster writes
  for (const auto& [folder, of_folder] : stems) {
    std::error_code error;
    for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
      std::error_code ignored;
      if (is_left(entry->path().filename().string(), of_folder)) fs::remove(entry->path(), ignored);
    }
  }
}

fs::path state_folder(const fs::path& results) {
  return results / kStateFolder;
}

fs::path record_path(const fs::path& results, const PlannedJob& job) {
  return state_folder(results) / (stem_of_record(job) + ".json");
}

fs::path thumbnail_path(const fs::path& results, const PlannedJob& job) {
  return state_folder(results) / (stem_of_record(job) + ".png");
}

std::optional<JobRecord> known_record(const fs::path& results, const PlannedJob& job) {
  const std::optional<Json> json = json_in(record_path(results, job));
  if (!json) return std::nullopt;
  try {
    if (json->at("record_version") != kRecordVersion || json->at("key") != job.key) return std::nullopt;
    JobRecord record;
    record.outcome = outcome_called(json->at("outcome"));
    record.exit_code = json->at("exit_code");
    record.message = json->at("message");
    record.seconds = json->at("seconds");
    record.seconds_in_job = json->at("seconds_in_job");
    record.peak_memory_bytes = json->at("peak_memory_bytes");
    for (const FigureRow& row : kFigureRows) {
      const Json& figure = json->at("figures").at(row.name);
      if (figure.is_number()) record.figures.*row.figure = figure.get<double>();
    }
    record.bytes_of_files = json->at("bytes_of_files").get<std::map<std::string, std::uintmax_t>>();
    if (record.outcome == Outcome::not_done) return std::nullopt;
    if (record.outcome != Outcome::done) return record;
    for (const fs::path& file : job.paths.all()) {
      const auto known = record.bytes_of_files.find(kind_of(file, job));
      if (known == record.bytes_of_files.end() || !is_as_it_was_written(file, known->second))
        return std::nullopt;
    }
    return record;
  } catch (const Json::exception&) {
    return std::nullopt;
  }
}

void forget(const fs::path& results, const PlannedJob& job) {
  std::error_code ignored;
  const fs::path record = record_path(results, job);
  if (const std::optional<Json> json = json_in(record); json && json->contains("bytes_of_files")) {
    const fs::path stem = job.paths.result.parent_path() / job.paths.result.stem();
    for (const auto& [ending, bytes] : json->at("bytes_of_files").items()) {
      const fs::path file = ending == kPlugs ? job.paths.plugs : fs::path(stem.string() + ending);
      if (bytes.is_number_unsigned() && is_as_it_was_written(file, bytes.get<std::uintmax_t>()))
        fs::remove(file, ignored);
    }
  }
  fs::remove(thumbnail_path(results, job), ignored);
  fs::remove(record, ignored);
}

void remove_files(const PlannedJob& job) {
  std::error_code ignored;
  for (const fs::path& file : job.paths.all()) fs::remove(file, ignored);
}

void keep(const fs::path& results, const PlannedJob& job, const JobRecord& record) {
  Json figures = Json::object();
  for (const FigureRow& row : kFigureRows) {
    const auto& figure = record.figures.*row.figure;
    figures[row.name] = figure ? Json(*figure) : Json(nullptr);
  }
  Json bytes = Json::object();
  for (const fs::path& file : job.paths.all()) {
    std::error_code error;
    const std::uintmax_t size = fs::file_size(file, error);
    if (!error) bytes[kind_of(file, job)] = size;
  }
  const Json json{{"schema", "aerate.batch.record"},
                  {"record_version", kRecordVersion},
                  {"key", job.key},
                  {"result", job.name.string()},
                  {"model", job.model.string()},
                  {"outcome", name_of(record.outcome)},
                  {"exit_code", record.exit_code},
                  {"message", record.message},
                  {"seconds", record.seconds},
                  {"seconds_in_job", record.seconds_in_job},
                  {"peak_memory_bytes", record.peak_memory_bytes},
                  {"figures", figures},
                  {"bytes_of_files", bytes}};
  PendingFile file(record_path(results, job));
  write_bytes(json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n", file);
  file.commit();
  mark_ended(results, job);
}

void mark_begun(const fs::path& results, const PlannedJob& job) {
  write_bytes("", mark_of(results, job));
}

void mark_ended(const fs::path& results, const PlannedJob& job) {
  std::error_code ignored;
  fs::remove(mark_of(results, job), ignored);
}

bool is_marked_begun(const fs::path& results, const PlannedJob& job) {
  std::error_code ignored;
  return fs::exists(mark_of(results, job), ignored);
}

void read_report(const fs::path& report, JobRecord& record) {
  const std::optional<Json> json = json_in(report);
  if (!json) return;
  const auto number_at = [&](const char* pointer) -> std::optional<double> {
    const Json::json_pointer place(pointer);
    if (!json->contains(place) || !json->at(place).is_number()) return std::nullopt;
    return json->at(place).get<double>();
  };
  for (const FigureRow& row : kFigureRows) record.figures.*row.figure = number_at(row.in_report);
  record.seconds_in_job = number_at("/seconds").value_or(0);
  record.peak_memory_bytes = number_at("/peak_memory_bytes").value_or(0);
}

}  // namespace aerate::batch
