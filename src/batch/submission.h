#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "batch/plan_jobs.h"
#include "batch/task_arrays.h"

namespace aerate::batch {

// What was handed to a cluster: all that its tasks, and who asks for them later, need to know. Kept in the folder of results.
struct Submission {
  std::string name;                           // of its arrays in the cluster, no other has it
  std::string version;                        // of the program
  std::filesystem::path working_folder = {};  // that names of models are relative to
  int threads = 1;                            // of each model
  std::vector<PlannedJob> plan = {};          // all of the batch, done or not
  std::vector<TaskArray> arrays = {};
  bool is_over = false;  // it has been seen that none of its tasks is under way
};

// The folder in which submissions are kept, and in which tasks write what they say.
std::filesystem::path submissions_folder(const std::filesystem::path& results);

// The file of a submission, which tasks are given; and the folder of results that it is of.
std::filesystem::path submission_path(const std::filesystem::path& results, const std::string& name);
std::filesystem::path results_of(const std::filesystem::path& submission);

// Where a task of an array writes what it says.
std::filesystem::path task_log(const std::filesystem::path& results, const TaskArray& array,
                               std::size_t task);

// Written whole or not at all, and known as the last one. Throws FailureError.
void keep_submission(const std::filesystem::path& results, const Submission& submission);

// Paths of results are as the file's own is. Throws InputError for a file that is none, or of another form.
Submission read_submission(const std::filesystem::path& file);

// Nothing if there is none. Throws as read_submission does.
std::optional<Submission> last_submission(const std::filesystem::path& results);

// None of its tasks is under way any more. Where that cannot be written, nothing is lost but the knowledge.
void mark_submission_over(const std::filesystem::path& results, const Submission& submission);

// Removes all that is known of submissions, of which none is under way.
void clear_submissions(const std::filesystem::path& results);

}  // namespace aerate::batch
