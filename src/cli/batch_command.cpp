#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <chrono>
#include <deque>
#include <filesystem>
#include <fmt/format.h>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <tbb/info.h>
#include <utility>
#include <vector>

#include "batch/find_models.h"
#include "batch/given_options.h"
#include "batch/job_state.h"
#include "batch/plan_jobs.h"
#include "batch/run_jobs.h"
#include "batch/summary.h"
#include "cli/commands.h"
#include "cli/hollow_forms.h"
#include "cli/interrupt.h"
#include "cli/numbers.h"
#include "cli/option_form.h"
#include "cli/process_options.h"
#include "cli/terminal.h"
#include "core/error.h"
#include "core/listed.h"
#include "core/printable.h"
#include "files/formats.h"
#include "pipeline/memory.h"
#include "pipeline/own_processes.h"

namespace aerate::cli {
namespace {

namespace fs = std::filesystem;
using batch::BatchRow;
using batch::GivenOption;
using batch::OptionRule;
using batch::Outcome;
using batch::PlannedJob;

// Exit status of a batch beside those of all commands.
constexpr ExitCode kSomeNotDone{6}, kNoneDone{7};

constexpr const char* kVersion = "aerate " AERATE_VERSION;

// Those of 'aerate hollow' that the batch has in a form of its own, since each model has files of its own.
constexpr std::array<std::string_view, 8> kNotTakenOver{"help", "output", "json",    "picture",
                                                        "view", "plugs",  "threads", "quiet"};

bool is_taken_over(const CLI::Option& option) {
  return !option.get_lnames().empty() &&
         std::ranges::find(kNotTakenOver, option.get_lnames().front()) == kNotTakenOver.end();
}

OptionRule rule_of(const CLI::Option& option) {
  OptionRule rule{.name = option.get_lnames().front()};
  const OptionForm form = form_of(option);
  rule.may_be_off = form.may_be_off;
  rule.may_be_bare = form.may_be_bare;
  rule.names_file = option.get_type_name() == "FILE";
  if (form.is_list)
    rule.kind = OptionRule::Kind::list;
  else if (form.is_flag)
    rule.kind = OptionRule::Kind::flag;
  return rule;
}

// The options of 'aerate hollow' on another command, where their values are taken as they stand: what they mean is found out by that one.
class TakenOptions {
 public:
  explicit TakenOptions(CLI::App& command) {
    visit_hollow_options([&](const CLI::Option& option) {
      if (is_taken_over(option)) add(command, option);
    });
  }

  const std::vector<OptionRule>& rules() const { return rules_; }

  std::vector<GivenOption> given() const {
    std::vector<GivenOption> given;
    for (std::size_t i = 0; i < rules_.size(); ++i) {
      if (options_[i]->count() == 0) continue;
      const bool is_plain_flag = rules_[i].kind == OptionRule::Kind::flag && !rules_[i].may_be_bare;
      GivenOption option{.name = rules_[i].name};
      if (is_plain_flag)
        option.is_off = values_[i].back() == "false";
      else
        option.values = values_[i];
      given.push_back(std::move(option));
    }
    return given;
  }

 private:
  void add(CLI::App& command, const CLI::Option& option) {
    const OptionRule& rule = rules_.emplace_back(rule_of(option));
    std::vector<std::string>& values = values_.emplace_back();
    const std::string names = option.get_name(false, true);
    const bool is_flag = form_of(option).is_flag || rule.may_be_bare;
    CLI::Option* const added = is_flag ? command.add_flag(names, values, option.get_description())
                                       : command.add_option(names, values, option.get_description());
    if (!is_flag) added->expected(1)->allow_extra_args(false);
    added->multi_option_policy(rule.kind == OptionRule::Kind::list ? CLI::MultiOptionPolicy::TakeAll
                                                                   : CLI::MultiOptionPolicy::TakeLast);
    if (!is_flag || rule.may_be_bare) added->type_name(option.get_type_name());
    if (!is_flag) added->default_str(option.get_default_str());
    added->group(option.get_group());
    if (rule.name == "process") added->check(CLI::Validator(list_if_asked, ""));
    options_.push_back(added);
  }

  // As 'aerate hollow' does, while the line is parsed.
  static std::string list_if_asked(const std::string& process) {
    if (process == "list") throw ProcessListRequest();
    return {};
  }

  std::vector<OptionRule> rules_;
  std::deque<std::vector<std::string>> values_;  // which options refer to
  std::vector<const CLI::Option*> options_;
};

std::string in_time(double seconds) {
  if (seconds < 120) return fmt::format("{:.1f} s", seconds);
  return seconds < 7200 ? fmt::format("{:.0f} min", seconds / 60) : fmt::format("{:.1f} h", seconds / 3600);
}

// A row in words.
std::string told(const BatchRow& row) {
  const batch::JobRecord& record = row.record;
  const std::string model = printable(row.job->model.string());
  if (record.outcome != Outcome::done)
    return fmt::format("{}: {}{}: {}", name_of(record.outcome), model,
                       row.job->origin.empty() ? "" : fmt::format(" ({})", printable(row.job->origin)),
                       printable(record.message));
  const auto& share = record.figures.removed_percent;
  return fmt::format("done: {} ({}{})", printable(row.job->name.string()),
                     share ? fmt::format("{:.1f} % removed, ", *share) : "", in_time(record.seconds));
}

// The program that runs, whatever its file is called by now.
fs::path this_program() {
  return "/proc/self/exe";
}

struct BatchCommand {
  explicit BatchCommand(CLI::App& command) : hollow_options(command) {
    command
        .add_option(
            "MODELS", places,
            "Models, folders of models, and manifests (.csv or .jsonl): tables whose columns are 'model', "
            "'output' and long names of the options below, which are set for that model")
        ->required()
        ->type_name("");
    command
        .add_option("-o,--output", output,
                    "The folder that results, reports, logs and the summary are written to")
        ->required()
        ->type_name("FOLDER");
    command
        .add_option("--name", name,
                    "The result's name, and with it its format: {name} is the model's, {folder} that of its "
                    "folder, {process} what prints it, {n} its number in the batch (default "
                    "{name}-hollow.stl, or the ending that --flavor has)")
        ->type_name("TEMPLATE");
    command.add_flag("--recursive", is_recursive,
                     "Look in the folders below folders too; their names are kept in the folder of results");
    command.add_flag("--pictures", pictures, "A picture beside each result (.png), small in the summary");
    command.add_flag("--views", pages, "A page beside each result (.html), to turn and cut in a browser");
    command.add_flag("--plugs", plugs, "A file of plugs for escape holes beside each result (NAME-plugs)");
    command
        .add_option("--jobs", jobs,
                    "So many models at a time, each in a process of its own (default as many as there are "
                    "threads); fewer while their estimated memory is more than there is")
        ->check(whole_number_between(1, 1024, "jobs"))
        ->type_name("N");
    command
        .add_option("--threads", threads, "Threads of all jobs together (default all); results are the same")
        ->check(whole_number_between(1, 1024, "threads"))
        ->type_name("N");
    command.add_flag("--dry-run", is_dry_run,
                     "Only say what would be done, with estimates of memory and time");
    command.add_flag("--retry-failed", retry_failed,
                     "Try those again that were not done; otherwise they are when something changed");
    command.add_flag("--quiet", is_quiet, "No line for each model, no notices; only errors");
    command.fallthrough();
  }

  Verbosity verbosity() const { return is_quiet ? Verbosity::quiet : Verbosity::normal; }

  batch::Understood understand(std::vector<std::string> arguments) const {
    std::vector<fs::path> files;
    for (const std::string& argument : arguments) {
      constexpr std::string_view kProcess = "--process=";
      if (!argument.starts_with(kProcess)) continue;
      if (auto file = own_process_file(argument.substr(kProcess.size()))) files.push_back(*std::move(file));
    }
    if (pictures) arguments.emplace_back("--picture=picture.png");
    if (plugs) arguments.emplace_back("--plugs=plugs.stl");
    const std::vector<JobForm> forms = forms_of_hollow("model", "result", std::move(arguments));
    const HollowOptions& options = forms.front().options;
    return {options.packing.process.process.name, options.output.extension().string(), std::move(files)};
  }

  batch::RunBounds bounds() const {
    constexpr double kShareOfMemory = 0.8;
    const int all = threads ? static_cast<int>(*threads) : tbb::info::default_concurrency();
    return {.jobs = jobs ? static_cast<int>(*jobs) : all,
            .threads = all,
            .memory_bytes = kShareOfMemory * available_memory_bytes()};
  }

  std::vector<PlannedJob> planned(Monitor& monitor) const {
    const std::vector<GivenOption> given = hollow_options.given();
    // What is wrong for all is said once, before anything else.
    static_cast<void>(understand(arguments_of(given)));
    const std::vector<batch::FoundModel> found = batch::find_models(
        {.places = {places.begin(), places.end()}, .is_recursive = is_recursive, .results = output},
        hollow_options.rules(), monitor);
    return batch::plan_jobs(
        found,
        {.results = output,
         .name = name,
         .options = given,
         .pictures = pictures,
         .pages = pages,
         .plugs = plugs,
         .version = kVersion},
        hollow_options.rules(),
        [this](const std::vector<std::string>& arguments) { return understand(arguments); }, monitor);
  }

  void run() const {
    InterruptGuard interrupt;
    TerminalMonitor monitor(interrupt, verbosity());
    const std::vector<PlannedJob> plan = planned(monitor);
    if (is_dry_run) {
      tell_plan(plan);
      return;
    }
    const batch::ResultsFolder results(output, plan, monitor);
    std::vector<BatchRow> rows = batch::known_rows(plan, output, retry_failed);
    const std::vector<BatchRow*> to_do = batch::rows_to_do(rows);
    if (!is_quiet)
      for (const BatchRow& row : rows)
        if (row.record.outcome != Outcome::done && row.record.outcome != Outcome::not_done)
          std::cout << told(row) << "\n";
    do_jobs(to_do, rows, results, monitor);
    finish(rows, to_do.size());
  }

  void do_jobs(const std::vector<BatchRow*>& to_do, const std::vector<BatchRow>& rows,
               const batch::ResultsFolder& results, Monitor& monitor) const {
    using Clock = std::chrono::steady_clock;
    constexpr auto kBetweenSummaries = std::chrono::seconds(10);
    std::size_t ended = 0;
    Clock::time_point last = Clock::now();
    const auto tell = [&](const BatchRow& row) {
      ++ended;
      if (!is_quiet) std::cout << fmt::format("[{}/{}] {}\n", ended, to_do.size(), told(row)) << std::flush;
      if (Clock::now() - last < kBetweenSummaries) return;
      try_to_summarise(rows);
      last = Clock::now();
    };
    try {
      batch::run_jobs(to_do, this_program(), results, bounds(), tell, monitor);
    } catch (const InterruptedError&) {
      try_to_summarise(rows);
      throw Error(ExitCode::interrupted,
                  fmt::format("interrupted: {} of {} models are done", counts_of(rows).done, rows.size()),
                  "the same command goes on from there");
    }
  }

  // On the way, where it is no loss if it cannot be.
  void try_to_summarise(const std::vector<BatchRow>& rows) const {
    try {
      write_summary(rows, output, kVersion);
    } catch (const FailureError& error) {
      if (!is_quiet) print_note(error.what());
    }
  }

  void finish(const std::vector<BatchRow>& rows, std::size_t in_this_run) const {
    const batch::Counts counts = counts_of(rows);
    const bool is_all = counts.done == rows.size();
    if (is_all) {
      write_summary(rows, output, kVersion);
    } else {
      try_to_summarise(rows);
    }
    const fs::path page = fs::path(output) / "summary.html";
    if (!is_quiet)
      std::cout << fmt::format("{} of {} {} done, {} in this run; {}\n", counts.done,
                               counted(rows.size(), "model", "models"), rows.size() == 1 ? "is" : "are",
                               in_this_run, printable(page.string()));
    require_stdout_written();
    if (is_all) return;
    throw Error(
        counts.done > 0 ? kSomeNotDone : kNoneDone,
        fmt::format("{} of {} could not be hollowed", counts.not_done,
                    counted(rows.size(), "model", "models")),
        fmt::format("{} has the reasons; they are tried again when something changed, or with --retry-failed",
                    page.string()));
  }

  void tell_plan(const std::vector<PlannedJob>& plan) const {
    std::vector<BatchRow> rows = batch::known_rows(plan, output, retry_failed);
    double seconds = 0, most_memory = 0;
    const std::vector<BatchRow*> to_do = batch::rows_to_do(rows);
    for (const BatchRow& row : rows) {
      const PlannedJob& job = *row.job;
      if (row.record.outcome != Outcome::not_done) {
        std::cout << (row.record.outcome == Outcome::done ? "is " : "") << told(row) << "\n";
        continue;
      }
      seconds += job.estimate.seconds;
      most_memory = std::max(most_memory, job.estimate.memory_bytes);
      std::cout << fmt::format("to do: {} -> {} (about {:.2g} triangles, {}, {})\n",
                               printable(job.model.string()), printable(job.paths.result.string()),
                               job.estimate.triangles, format_bytes(job.estimate.memory_bytes),
                               in_time(job.estimate.seconds));
    }
    const batch::Counts counts = counts_of(rows);
    std::cout << fmt::format("{} to do, {} done, {} not", to_do.size(), counts.done, counts.not_done);
    if (!to_do.empty()) {
      const batch::Shares shares = batch::shares_of(bounds(), to_do.size());
      std::cout << fmt::format(
          "; about {}, {} at a time with {}, {} each at most", in_time(seconds / shares.jobs), shares.jobs,
          counted(static_cast<std::size_t>(shares.threads), "thread", "threads"), format_bytes(most_memory));
    }
    std::cout << "\n";
    require_stdout_written();
  }

  TakenOptions hollow_options;
  std::vector<std::string> places;
  std::string output, name;
  bool is_recursive = false, pictures = false, pages = false, plugs = false;
  bool is_dry_run = false, retry_failed = false, is_quiet = false;
  std::optional<double> jobs, threads;
};

}  // namespace

void add_batch_command(CLI::App& app, const ConfigFile& /*config*/) {
  CLI::App& command = *app.add_subcommand(
      "batch", "Hollow many models, each in a process of its own; goes on where it was stopped");
  command.callback([job = std::make_shared<BatchCommand>(command)] { job->run(); });
  command.footer(
      "Options of 'aerate hollow' hold for all models, those of a manifest for theirs. docs/batch.md "
      "describes "
      "manifests and the summary.\n"
      "Exit status: 0 all are done, 6 some are not, 7 none is; 1, 2 and 3 as for other commands, before any "
      "is begun;\n"
      "130 interrupted, after what was under way has been stopped.");
}

}  // namespace aerate::cli
