#include <chrono>
#include <csignal>
#include <fstream>
#include <gtest/gtest.h>
#include <regex>
#include <sstream>
#include <string>
#include <sys/stat.h>
#include <thread>
#include <vector>

#include "tests/cli/job.h"
#include "tests/support/caught.h"
#include "tests/support/raw_socket.h"
#include "view/built_files.h"

namespace aerate::test {
namespace {

namespace fs = std::filesystem;

std::string content_of(const fs::path& path) {
  std::ostringstream content;
  content << std::ifstream(path, std::ios::binary).rdbuf();
  return content.str();
}

// Until a file has what it is to have.
std::string wait_for(const fs::path& file, const std::string& text) {
  for (int i = 0; i < 2000 && content_of(file).find(text) == std::string::npos; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  return content_of(file);
}

class StudioCommandTest : public testing::Test {
 protected:
  void SetUp() override {
    if (!built_file("studio.html"))
      GTEST_SKIP() << "built without the studio: " << why_no_built_file("studio.html");
    fs::create_directory(temporary());
  }
  fs::path temporary() const { return job_.folder() / "tmp"; }
  fs::path printed() const { return job_.folder() / "printed"; }

  // aerate studio ARGUMENTS..., whose standard output can be read while it runs.
  std::vector<std::string> studio(const std::string& arguments) const {
    return {"sh", "-c",
            std::string("exec ") + AERATE_EXECUTABLE + " studio " + arguments + " >" + printed().string()};
  }
  std::vector<std::pair<std::string, std::string>> environment(const std::string& browser = "") const {
    return {{"TMPDIR", temporary()}, {"BROWSER", browser}, {"DISPLAY", ""}, {"WAYLAND_DISPLAY", ""}};
  }
  struct Address {
    int port = 0;
    std::string token;
  };
  Address address() const {
    const std::string text = wait_for(printed(), "\n");
    std::smatch match;
    const std::regex form("http://127\\.0\\.0\\.1:([0-9]+)/#([0-9a-f]{32,})\n");
    if (!std::regex_match(text, match, form)) {
      ADD_FAILURE() << text;
      return {};
    }
    return {std::stoi(match[1]), match[2]};
  }
  static std::string ask(const Address& at, const std::string& request) {
    const RawSocket socket(at.port);
    socket.send(request + " HTTP/1.1\r\nHost: 127.0.0.1:" + std::to_string(at.port) +
                "\r\nAuthorization: Bearer " + at.token + "\r\n\r\n");
    return socket.receive();
  }

  const Job job_;
};

TEST_F(StudioCommandTest, RunsUntilItIsInterruptedAndLeavesNothing) {
  const fs::path model = job_.input("block.stl", block());
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    Process process(studio("--no-browser " + model.string()), environment());
    const Address at = address();
    EXPECT_TRUE(contains(ask(at, "GET /"), "200 OK"));
    EXPECT_TRUE(contains(ask(at, "GET /api/state"), "block.stl"));
    EXPECT_FALSE(fs::is_empty(temporary()));
    process.send(signal);
    const ProcessResult result = process.wait();
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_TRUE(fs::is_empty(temporary()));
    EXPECT_EQ(result.err.find(at.token), std::string::npos) << result.err;
    fs::remove(printed());
  }
}

TEST_F(StudioCommandTest, EndsAJobUnderWay) {
  const fs::path model = job_.input("block.stl", block());
  Process process(studio("--no-browser " + model.string()), environment());
  const Address at = address();
  const std::string body =
      R"({"model":"m1","options":{"max-radius":"0.8","min-radius":"0.3","gap":"0.3","shape":"spheres"}})";
  const RawSocket socket(at.port);
  socket.send("POST /api/jobs HTTP/1.1\r\nHost: 127.0.0.1:" + std::to_string(at.port) +
              "\r\nAuthorization: Bearer " + at.token + "\r\nContent-Length: " + std::to_string(body.size()) +
              "\r\n\r\n" + body);
  EXPECT_TRUE(contains(socket.receive(), "\"id\":\"j1\""));
  process.send(SIGTERM);
  EXPECT_EQ(process.wait().exit_code, 0);
  EXPECT_TRUE(fs::is_empty(temporary()));
}

TEST_F(StudioCommandTest, APortInUseIsToldWithWhatToDo) {
  Process first(studio("--no-browser"), environment());
  const int port = address().port;
  const ProcessResult second =
      Process({AERATE_EXECUTABLE, "studio", "--no-browser", "--port", std::to_string(port)}, environment())
          .wait();
  EXPECT_EQ(second.exit_code, 2);
  EXPECT_TRUE(contains(second.err, "--port " + std::to_string(port)));
  EXPECT_TRUE(contains(second.err, "leave out --port"));
  EXPECT_EQ(second.out, "");
}

// A browser's command line is for every user of the machine to read.
TEST_F(StudioCommandTest, TheBrowserGetsAFileThatLeadsToTheAddress) {
  const fs::path browser =
      job_.input("browser", "#!/bin/sh\nstat -c %a \"$1\" >" + (job_.folder() / "mode").string() +
                                "\ncp \"$1\" " + (job_.folder() / "page").string() + "\necho \"$@\" >" +
                                (job_.folder() / "arguments").string() + "\n");
  fs::permissions(browser, fs::perms::owner_all);
  Process process(studio(""), environment(browser));
  const Address at = address();
  const std::string arguments = wait_for(job_.folder() / "arguments", "\n");
  EXPECT_EQ(arguments.find(at.token), std::string::npos) << arguments;
  EXPECT_TRUE(contains(arguments, "open.html"));
  EXPECT_EQ(content_of(job_.folder() / "mode"), "600\n");
  EXPECT_TRUE(contains(content_of(job_.folder() / "page"),
                       "url=http://127.0.0.1:" + std::to_string(at.port) + "/#" + at.token));
}

TEST_F(StudioCommandTest, ModelsThatCannotBeReadEndItAsOtherCommands) {
  const fs::path junk = job_.input("junk.3mf", "junk");
  const ProcessResult result =
      Process({AERATE_EXECUTABLE, "studio", "--no-browser", junk}, environment()).wait();
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_TRUE(contains(result.err, "junk.3mf"));
  EXPECT_TRUE(fs::is_empty(temporary()));
  EXPECT_EQ(
      Process({AERATE_EXECUTABLE, "studio", "--no-browser", "missing.stl"}, environment()).wait().exit_code,
      3);
}

TEST_F(StudioCommandTest, LargestUploadsAreAsAskedFor) {
  const fs::path model = job_.input("block.stl", block());
  const ProcessResult result =
      Process({AERATE_EXECUTABLE, "studio", "--no-browser", "--max-upload", "500", model}, environment())
          .wait();
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_TRUE(contains(result.err, "--max-upload"));
  for (const char* size : {"0", "-1", "x", "1T", "1e99", ""})
    EXPECT_EQ(Process({AERATE_EXECUTABLE, "studio", "--no-browser", "--max-upload", size}, environment())
                  .wait()
                  .exit_code,
              2)
        << size;
}

TEST_F(StudioCommandTest, OthersAreLetInOnlyWithAWarning) {
  Process process(studio("--no-browser --host 0.0.0.0"), environment());
  wait_for(printed(), "\n");
  process.send(SIGTERM);
  EXPECT_TRUE(contains(process.wait().err, "not encrypted"));
  EXPECT_EQ(Process({AERATE_EXECUTABLE, "studio", "--host", "evil.example"}, environment()).wait().exit_code,
            2);
}

TEST(StudioCommand, SaysWhatIsMissingWhereItWasBuiltWithout) {
  if (built_file("studio.html")) GTEST_SKIP() << "built with the studio";
  const ProcessResult result = Process({AERATE_EXECUTABLE, "studio", "--no-browser"}).wait();
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_TRUE(contains(result.err, why_no_built_file("studio.html")));
}

}  // namespace
}  // namespace aerate::test
