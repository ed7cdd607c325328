#include <algorithm>
#include <csignal>
#include <fstream>
#include <functional>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <sys/resource.h>
#include <vector>

#include "core/error.h"
#include "files/load.h"
#include "pipeline/hollow.h"
#include "tests/studio/studio_folder.h"
#include "tests/support/caught.h"

namespace aerate::studio {
namespace {

namespace fs = std::filesystem;
using test::contains;
using Json = nlohmann::json;

std::string content_of(const fs::path& path) {
  std::ostringstream content;
  content << std::ifstream(path, std::ios::binary).rdbuf();
  return content.str();
}

Refusal refusal_by(const std::function<void()>& act) {
  try {
    act();
    ADD_FAILURE() << "nothing was thrown";
  } catch (...) {
    return refusal_of(std::current_exception());
  }
  return {};
}

// Files can become no larger than this, which is told as a full disk is but for the word.
class FullDisk {
 public:
  explicit FullDisk(rlim_t bytes) {
    std::signal(SIGXFSZ, SIG_IGN);
    ::getrlimit(RLIMIT_FSIZE, &before_);
    rlimit little = before_;
    little.rlim_cur = bytes;
    ::setrlimit(RLIMIT_FSIZE, &little);
  }
  ~FullDisk() { ::setrlimit(RLIMIT_FSIZE, &before_); }
  FullDisk(const FullDisk&) = delete;
  FullDisk& operator=(const FullDisk&) = delete;

 private:
  rlimit before_{};
};

Mesh open_box() {
  Mesh mesh = test::make_box({0, 0, 0}, {30, 30, 30});
  mesh.triangles.resize(mesh.triangles.size() / 2);
  return mesh;
}

TEST(StudioModels, AreInspectedUnderTheirNames) {
  StudioFolder folder;
  const ModelRecord model = folder.upload_block();
  EXPECT_EQ(model.id, "m1");
  EXPECT_TRUE(model.is_usable);
  const Json report = Json::parse(model.inspection);
  EXPECT_EQ(report["input"]["path"], "block.stl");
  EXPECT_EQ(report["input"]["triangles"], 12);
  EXPECT_GT(fs::file_size(folder.studio().scene_of_model("m1").path), 100u);
  EXPECT_EQ(folder.studio().models().size(), 1u);
}

TEST(StudioModels, ThatCannotBeReadAreRefusedAndLeaveNothing) {
  StudioFolder folder;
  const Refusal refusal = refusal_by([&] { folder.upload("junk.3mf", "PK nothing"); });
  EXPECT_EQ(refusal.status, 422);
  EXPECT_EQ(refusal.exit, static_cast<int>(ExitCode::unreadable_input));
  EXPECT_TRUE(contains(refusal.what, "junk.3mf"));
  EXPECT_EQ(refusal.what.find(folder.path().string()), std::string::npos) << refusal.what;
  EXPECT_EQ(refusal_by([&] { folder.upload("model.exe", "MZ"); }).status, 422);
  EXPECT_EQ(folder.entries(), 0u);
  EXPECT_TRUE(folder.studio().models().empty());
}

TEST(StudioModels, ThatCannotBeUsedAreShownWithWhatIsWrong) {
  StudioFolder folder;
  const ModelRecord model = folder.upload("open.stl", test::to_binary_stl(open_box()));
  EXPECT_FALSE(model.is_usable);
  EXPECT_TRUE(contains(model.use, "open.stl"));
  EXPECT_EQ(model.use.find(folder.path().string()), std::string::npos) << model.use;
  EXPECT_TRUE(fs::exists(folder.studio().scene_of_model(model.id).path));
  const Refusal refusal = refusal_by([&] { folder.studio().outlook(model.id, {}); });
  EXPECT_EQ(refusal.exit, static_cast<int>(ExitCode::unusable_mesh));
  folder.studio().start_job(model.id, {}, "{}");
  const JobRecord job = folder.wait_for("j1");
  EXPECT_EQ(job.state, JobState::failed);
  EXPECT_EQ(job.error->exit, static_cast<int>(ExitCode::unusable_mesh));
  EXPECT_TRUE(contains(model.use, job.error->what)) << "both say the same";
}

TEST(StudioModels, AreCounted) {
  StudioFolder folder({.models = 2});
  folder.upload_block();
  {
    const auto coming = folder.studio().begin_upload("second.stl");
    EXPECT_EQ(refusal_by([&] { folder.studio().begin_upload("third.stl"); }).status, 429);
  }
  folder.upload_block();  // the second went
  EXPECT_EQ(refusal_by([&] { folder.upload_block(); }).status, 429);
  folder.studio().remove_model("m1");
  folder.upload_block();
  EXPECT_EQ(folder.entries(), 2u);
}

TEST(StudioModels, AreCountedInBytesWhileTheyCome) {
  StudioFolder folder({.body_bytes = 1000});
  const Refusal refusal = refusal_by([&] { folder.upload("large.stl", std::string(1001, 'x')); });
  EXPECT_EQ(refusal.status, 413);
  EXPECT_TRUE(contains(refusal.hint, "--max-upload"));
  EXPECT_EQ(folder.entries(), 0u);
}

TEST(StudioModels, ForWhichThereIsNoRoomLeaveNothing) {
  StudioFolder folder;
  const FullDisk full(4096);
  const Refusal refusal = refusal_by([&] { folder.upload("large.stl", std::string(100'000, 'x')); });
  EXPECT_EQ(refusal.status, 507);
  EXPECT_EQ(folder.entries(), 0u);
}

TEST(StudioJobs, ForWhichThereIsNoRoomLeaveNothing) {
  StudioFolder folder;
  folder.upload_block();
  const FullDisk full(4096);
  folder.studio().start_job("m1", {}, "{}");
  const JobRecord job = folder.wait_for("j1");
  EXPECT_EQ(job.state, JobState::failed);
  EXPECT_EQ(job.error->status, 507);
  EXPECT_EQ(job.error->exit, static_cast<int>(ExitCode::failure));
  EXPECT_FALSE(fs::exists(folder.path() / "j1"));
}

TEST(StudioJobs, MakeWhatTheCommandLineMakes) {
  StudioFolder folder;
  folder.upload_block();
  const std::vector<GivenOption> options{{"wall", {"3"}}};
  const JobRecord begun = folder.studio().start_job("m1", options, R"({"wall":"3"})");
  EXPECT_EQ(begun.command, "aerate hollow block.stl -o block-hollow.stl --wall=3");
  const JobRecord job = folder.wait_for("j1");
  ASSERT_EQ(job.state, JobState::done) << job.error->what;
  ASSERT_EQ(job.files.size(), 2u);
  EXPECT_EQ(job.files[0].form, "stl");
  EXPECT_EQ(job.files[0].name, "block-hollow.stl");
  EXPECT_EQ(job.files[1].form, "3mf");

  const test::TemporaryFolder elsewhere;
  Plan plan = folder.studio().outlook("m1", options).plan;
  for (JobForm& form : plan.forms) form.options.output = elsewhere.path() / "out.stl";
  Monitor monitor;
  hollow(plan.forms, monitor);
  const fs::path stl = folder.studio().result_of_job("j1", "stl").path;
  EXPECT_EQ(content_of(stl), content_of(elsewhere.path() / "out.stl"));
  EXPECT_EQ(fs::file_size(stl), job.files[0].bytes);
  EXPECT_EQ(load_model(folder.studio().result_of_job("j1", "3mf").path).mesh.triangles.size(),
            load_model(stl).mesh.triangles.size());

  const Json report = Json::parse(content_of(folder.studio().report_of_job("j1").path));
  EXPECT_EQ(report["input"]["path"], "block.stl");
  EXPECT_EQ(report["output"]["path"], "block-hollow.stl");
  for (const KeptFile& file : {folder.studio().report_of_job("j1"), folder.studio().report_text_of_job("j1")})
    EXPECT_EQ(content_of(file.path).find(folder.path().string()), std::string::npos);
  for (const std::string& notice : job.notices)
    EXPECT_EQ(notice.find(folder.path().string()), std::string::npos) << notice;
  EXPECT_GT(fs::file_size(folder.studio().scene_of_job("j1").path), 1000u);
}

TEST(StudioJobs, OfModifiersHaveTheOneFileThatHoldsThem) {
  StudioFolder folder;
  folder.upload_block();
  folder.studio().start_job("m1", {{"as", {"modifiers"}}}, "{}");
  const JobRecord job = folder.wait_for("j1");
  ASSERT_EQ(job.state, JobState::done) << job.error->what;
  ASSERT_EQ(job.files.size(), 1u);
  EXPECT_EQ(job.files[0].name, "block-hollow.3mf");
  EXPECT_EQ(refusal_by([&] { folder.studio().result_of_job("j1", "stl"); }).status, 404);
}

TEST(StudioJobs, WithSupportBlockersHaveAnStlWithout) {
  StudioFolder folder;
  folder.upload_block();
  folder.studio().start_job("m1", {{"support-blockers", {}}}, "{}");
  const JobRecord job = folder.wait_for("j1");
  ASSERT_EQ(job.state, JobState::done) << job.error->what;
  EXPECT_EQ(job.files.size(), 2u);
}

TEST(StudioJobs, RunOneAfterTheOther) {
  StudioFolder folder;
  folder.upload_block();
  for (int i = 0; i < 4; ++i) folder.studio().start_job("m1", {}, "{}");
  EXPECT_EQ(folder.studio().jobs().size(), 4u);
  std::uint64_t moment = 0;
  while (true) {
    moment = folder.studio().changes_after(moment, std::chrono::seconds(60)).moment;
    const std::vector<JobRecord> jobs = folder.studio().jobs();
    EXPECT_LE(std::ranges::count(jobs, JobState::running, &JobRecord::state), 1);
    for (std::size_t i = 0; i < jobs.size(); ++i)
      EXPECT_LE(jobs[i].waiting_before, jobs[i].state == JobState::waiting ? i : 0);
    if (std::ranges::all_of(jobs, [](const JobRecord& job) { return has_ended(job.state); })) break;
  }
  for (const JobRecord& job : folder.studio().jobs()) EXPECT_EQ(job.state, JobState::done);
}

TEST(StudioJobs, StopWhetherTheyRunOrWaitAndLeaveNothing) {
  StudioFolder folder;
  folder.upload_block();
  folder.studio().start_job("m1", long_job(), "{}");
  folder.studio().start_job("m1", {}, "{}");
  EXPECT_EQ(folder.studio().stop_job("j2").state, JobState::stopped);
  ASSERT_EQ(folder.wait_for("j1", JobState::running).state, JobState::running);
  folder.studio().stop_job("j1");
  const JobRecord job = folder.wait_for("j1", JobState::stopped);
  EXPECT_EQ(job.state, JobState::stopped);
  EXPECT_FALSE(job.error);
  EXPECT_FALSE(fs::exists(folder.path() / "j1"));
  EXPECT_EQ(refusal_by([&] { folder.studio().scene_of_job("j1"); }).status, 409);
  folder.studio().stop_job("j1");  // once more does nothing
  folder.studio().start_job("m1", {}, "{}");
  EXPECT_EQ(folder.wait_for("j3").state, JobState::done);
}

TEST(StudioJobs, ThatFailSayWhyAndLeaveNothing) {
  StudioFolder folder;
  folder.upload_block();
  folder.studio().start_job("m1", {{"wall", {"15"}}}, "{}");
  const JobRecord job = folder.wait_for("j1");
  EXPECT_EQ(job.state, JobState::failed);
  EXPECT_EQ(job.error->exit, static_cast<int>(ExitCode::nothing_to_remove));
  EXPECT_FALSE(fs::exists(folder.path() / "j1"));
  const Refusal refusal = refusal_by([&] { folder.studio().start_job("m1", {{"wall", {"-1"}}}, "{}"); });
  EXPECT_EQ(refusal.exit, static_cast<int>(ExitCode::usage));
  EXPECT_EQ(folder.entries(), 1u);
}

TEST(StudioJobs, AreCountedAndRemoved) {
  StudioFolder folder({.jobs = 2});
  folder.upload_block();
  folder.studio().start_job("m1", long_job(), "{}");
  folder.studio().start_job("m1", {}, "{}");
  EXPECT_EQ(refusal_by([&] { folder.studio().start_job("m1", {}, "{}"); }).status, 429);
  ASSERT_EQ(folder.wait_for("j1", JobState::running).state, JobState::running);
  EXPECT_EQ(refusal_by([&] { folder.studio().remove_job("j1"); }).status, 409);
  EXPECT_EQ(refusal_by([&] { folder.studio().remove_model("m1"); }).status, 409);
  folder.studio().stop_job("j1");
  folder.wait_for("j1", JobState::stopped);
  folder.wait_for("j2");
  folder.studio().remove_job("j2");
  EXPECT_FALSE(fs::exists(folder.path() / "j2"));
  EXPECT_EQ(refusal_by([&] { folder.studio().report_of_job("j2"); }).status, 404);
  folder.studio().remove_model("m1");
  EXPECT_EQ(folder.entries(), 0u);
}

TEST(StudioJobs, EndWithTheStudio) {
  StudioFolder folder;
  folder.upload_block();
  folder.studio().start_job("m1", long_job(), "{}");
  folder.wait_for("j1", JobState::running);
  folder.end();
  EXPECT_EQ(folder.entries(), 0u);
}

TEST(StudioChanges, AreToldOnceToWhoAsksOn) {
  StudioFolder folder;
  folder.upload_block();
  const Changes all = folder.studio().changes_after(0, {});
  EXPECT_EQ(all.models.size(), 1u);
  const Changes nothing = folder.studio().changes_after(all.moment, std::chrono::milliseconds(5));
  EXPECT_TRUE(nothing.models.empty() && nothing.jobs.empty() && nothing.removed.empty());
  folder.studio().remove_model("m1");
  const Changes gone = folder.studio().changes_after(all.moment, {});
  EXPECT_EQ(gone.removed, std::vector<std::string>{"m1"});
  EXPECT_TRUE(folder.studio().changes_after(0, {}).removed.empty()) << "who begins has not seen it";
}

TEST(StudioEstimate, CountsWhatIsDeeperThanTheWall) {
  StudioFolder folder;
  folder.upload_block();
  const JobEstimate estimate = folder.studio().outlook("m1", {{"wall", {"3"}}}).estimate.value();
  EXPECT_NEAR(estimate.solid_volume, 27000, 0.1);
  EXPECT_NEAR(estimate.deeper.from, 0.512, 0.02);  // (24/30)^3
  const JobEstimate inches = folder.studio()
                                 .outlook("m1", {{"wall", {"3"}}, {"unit", {"inch"}}, {"scale", {"0.5"}}})
                                 .estimate.value();
  EXPECT_NEAR(inches.solid_volume, 27000 * 12.7 * 12.7 * 12.7, 1e3);
  EXPECT_GT(inches.deeper.from, 0.9);
  const JobEstimate uneven =
      folder.studio().outlook("m1", {{"wall", {"3"}}, {"scale", {"1,1,2"}}}).estimate.value();
  EXPECT_LT(uneven.deeper.from, 0.64 * 54 / 60);  // the share of such a box
  EXPECT_GT(uneven.deeper.to, 0.64 * 54 / 60 - 0.02);
}

TEST(StudioEstimate, HoldsWhatTheJobRemoves) {
  StudioFolder folder;
  folder.upload_block();
  const std::vector<std::vector<GivenOption>> jobs{
      {}, {{"process", {"sla"}}}, {{"wall", {"4"}}, {"shape", {"cells"}}}, {{"target-saving", {"20"}}}};
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    const JobEstimate estimate = folder.studio().outlook("m1", jobs[i]).estimate.value();
    const std::string id = folder.studio().start_job("m1", jobs[i], "{}").id;
    const JobRecord job = folder.wait_for(id);
    ASSERT_EQ(job.state, JobState::done) << job.error->what;
    const Json volume = Json::parse(content_of(folder.studio().report_of_job(id).path))["volume"];
    const double removed = volume["removed_percent"].get<double>() / 100;
    EXPECT_GE(removed, estimate.removed.from - 0.005) << i;
    EXPECT_LE(removed, estimate.removed.to + 0.005) << i;
    EXPECT_LT(estimate.removed.from, estimate.removed.to) << i;
  }
}

TEST(StudioEstimate, SaysThatThereIsNoRoom) {
  StudioFolder folder;
  folder.upload_block();
  EXPECT_EQ(folder.studio().outlook("m1", {{"wall", {"15"}}}).estimate->removed.to, 0);
}

}  // namespace
}  // namespace aerate::studio
