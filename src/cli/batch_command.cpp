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
#include "cli/batch_outcome.h"
#include "cli/command_line.h"
#include "cli/commands.h"
#include "cli/hollow_forms.h"
#include "cli/interrupt.h"
#include "cli/numbers.h"
#include "cli/option_form.h"
#include "cli/process_options.h"
#include "cli/slurm_engine.h"
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

// Engines.
constexpr const char *kLocal = "local", *kSlurm = "slurm";

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

// This program, by the name that other machines know it by.
fs::path this_program() {
  std::error_code error;
  fs::path program = fs::read_symlink("/proc/self/exe", error);
  if (error) throw FailureError("/proc/self/exe: " + error.message());
  return program;
}

struct BatchCommand {
  explicit BatchCommand(CLI::App& command) : hollow_options(command) {
    command
        .add_option(
            "MODELS", places,
            "Models, folders of models, and manifests (.csv or .jsonl): tables whose columns are 'model', "
            "'output' and long names of the options below, which are set for that model")
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
    add_engine(command);
    command.add_flag("--quiet", is_quiet, "No line for each model, no notices; only errors");
    command.fallthrough();
  }

  void add_engine(CLI::App& command) {
    constexpr const char* kGroup = "On a cluster (Slurm)";
    const auto add = [&](const char* name_of_option, auto& value, const char* what, const char* type) {
      command.add_option(name_of_option, value, what)->type_name(type)->group(kGroup);
    };
    command
        .add_option(
            "--engine", engine,
            "What does the work: this machine (local), or a Slurm cluster as arrays of tasks (slurm); the "
            "folders have to be there under the same names on all its nodes")
        ->check(CLI::IsMember(std::vector<std::string>{kLocal, kSlurm}))
        ->type_name("ENGINE")
        ->default_str(kLocal)
        ->group(kGroup);
    command
        .add_flag("--wait", is_waiting,
                  "Wait for the cluster, then write the summary; otherwise return at once")
        ->group(kGroup);
    command
        .add_flag("--status", is_status, "How far the cluster is with -o FOLDER; no models are named then")
        ->group(kGroup);
    command.add_flag("--collect", is_collect, "Write the summary of what the cluster has done by now")
        ->group(kGroup);
    command.add_flag("--cancel", is_cancel, "End the cluster's tasks; what is done stays")->group(kGroup);
    add("--partition", partition, "The partition that tasks go to", "NAME");
    add("--account", account, "The account that they are for", "NAME");
    command
        .add_option(
            "--sbatch-option", sbatch_options,
            "One more option for 'sbatch' (--sbatch-option=--qos=low), which holds before what the batch "
            "would ask for; may be repeated")
        ->expected(1)
        ->allow_extra_args(false)
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
        ->type_name("OPTION")
        ->group(kGroup);
    command
        .add_option("--chunk", chunk,
                    "Models of a task, which does them one after the other (default by the "
                    "estimates, for 5 to 60 s)")
        ->check(whole_number_between(1, 100000, "models"))
        ->type_name("N")
        ->group(kGroup);
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
         .version = kBatchVersion},
        hollow_options.rules(),
        [this](const std::vector<std::string>& arguments) { return understand(arguments); }, monitor);
  }

  bool is_on_cluster() const { return engine == kSlurm; }

  // What is asked of a batch that is with the cluster already, instead of beginning one.
  bool is_asking() const { return is_status || is_collect || is_cancel; }

  void require_sense() const {
    if (places.empty() != is_asking())
      throw UsageError(
          places.empty() ? "MODELS is required" : "--status, --collect and --cancel take no models",
          "see 'aerate batch --help'");
    if (is_status + is_collect + is_cancel > 1)
      throw UsageError("--status, --collect and --cancel ask for different things", "give one of them");
    if (is_asking() && (is_waiting || is_dry_run))
      throw UsageError("--status, --collect and --cancel begin no batch", "leave out --wait and --dry-run");
    const bool has_cluster_options =
        is_waiting || !partition.empty() || !account.empty() || !sbatch_options.empty() || chunk;
    if (!is_on_cluster() && has_cluster_options && !is_asking())
      throw UsageError("--wait, --partition, --account, --sbatch-option and --chunk are for a cluster",
                       "give --engine slurm, or leave them out");
  }

  SlurmOptions slurm_options() const {
    return {.request = {.partition = partition,
                        .account = account,
                        .options = sbatch_options,
                        .most_tasks_at_a_time = jobs ? static_cast<int>(*jobs) : 0},
            .models_of_task = chunk ? static_cast<std::size_t>(*chunk) : 0,
            .threads = threads ? static_cast<int>(*threads) : 1,
            .is_quiet = is_quiet};
  }

  void run() const {
    require_sense();
    // Before there are threads.
    std::optional<OwnCommands> commands;
    if (!is_asking() && !is_dry_run && !is_on_cluster()) commands.emplace(exit_status_of);
    InterruptGuard interrupt;
    TerminalMonitor monitor(interrupt, verbosity());
    SlurmEngine cluster(output, slurm_options(), monitor);
    if (is_asking()) {
      ask(cluster);
      return;
    }
    const std::vector<PlannedJob> plan = planned(monitor);
    if (is_dry_run) {
      tell_plan(plan, cluster);
    } else if (is_on_cluster()) {
      run_on_cluster(plan, cluster, monitor);
    } else {
      run_here(plan, *commands, monitor);
    }
  }

  void ask(SlurmEngine& cluster) const {
    if (is_status) cluster.status();
    if (is_collect) cluster.collect();
    if (is_cancel) cluster.cancel();
  }

  void run_on_cluster(const std::vector<PlannedJob>& plan, SlurmEngine& cluster, Monitor& monitor) const {
    try {
      if (is_waiting) cluster.follow_if_any();
      require_no_cluster_at_work(output, monitor);
      const bool is_under_way = cluster.submit(plan, retry_failed, this_program());
      if (!is_under_way || !is_waiting) return;
      cluster.follow();
    } catch (const InterruptedError&) {
      throw Error(ExitCode::interrupted, "interrupted; what the cluster was given it goes on with",
                  fmt::format("'aerate batch -o {} --status' says how far it is, --cancel ends it", output));
    }
    cluster.collect();
  }

  void run_here(const std::vector<PlannedJob>& plan, const OwnCommands& commands, Monitor& monitor) const {
    require_no_cluster_at_work(output, monitor);
    const batch::ResultsFolder results(output, plan, monitor);
    require_no_cluster_at_work(output, monitor);  // that was begun in between
    std::vector<BatchRow> rows = batch::known_rows(plan, output, retry_failed);
    const std::vector<BatchRow*> to_do = batch::rows_to_do(rows);
    if (!is_quiet) tell_known_failures(rows);
    do_jobs(to_do, rows, results, commands, monitor);
    finish_batch(rows, output, to_do.size(), is_quiet);
  }

  void do_jobs(const std::vector<BatchRow*>& to_do, const std::vector<BatchRow>& rows,
               const batch::ResultsFolder& results, const OwnCommands& commands, Monitor& monitor) const {
    using Clock = std::chrono::steady_clock;
    constexpr auto kBetweenSummaries = std::chrono::seconds(10);
    std::size_t ended = 0;
    Clock::time_point last = Clock::now();
    const auto tell = [&](const BatchRow& row) {
      ++ended;
      if (!is_quiet) std::cout << fmt::format("[{}/{}] {}\n", ended, to_do.size(), told(row)) << std::flush;
      if (Clock::now() - last < kBetweenSummaries) return;
      try_to_summarise(rows, output, is_quiet);
      last = Clock::now();
    };
    try {
      const auto run = [&](const ChildCommand& command, Monitor& of_job) {
        return commands.run(command, of_job);
      };
      batch::run_jobs(to_do, run, results, bounds(), tell, monitor);
    } catch (const InterruptedError&) {
      try_to_summarise(rows, output, is_quiet);
      throw Error(ExitCode::interrupted,
                  fmt::format("interrupted: {} of {} models are done", counts_of(rows).done, rows.size()),
                  "the same command goes on from there");
    }
  }

  void tell_plan(const std::vector<PlannedJob>& plan, const SlurmEngine& cluster) const {
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
    if (!to_do.empty() && is_on_cluster()) std::cout << "; " << cluster.in_words(to_do);
    if (!to_do.empty() && !is_on_cluster()) {
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
  std::optional<double> jobs, threads, chunk;
  std::string engine = kLocal, partition, account;
  std::vector<std::string> sbatch_options;
  bool is_waiting = false, is_status = false, is_collect = false, is_cancel = false;
};

// What tasks of a cluster run.
struct TaskCommand {
  explicit TaskCommand(CLI::App& command) {
    command.add_option("SUBMISSION", submission, "")->required();
    command.add_option("ARRAY", array, "")->required();
  }

  void run() const {
    InterruptGuard interrupt;
    TerminalMonitor monitor(interrupt, Verbosity::normal);
    run_cluster_task(submission, array, monitor);
  }

  std::string submission;
  std::size_t array = 0;
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
  CLI::App& task = *app.add_subcommand("batch-task", "")->group("");
  task.callback([job = std::make_shared<TaskCommand>(task)] { job->run(); });
}

}  // namespace aerate::cli
