#include <chrono>
#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <iostream>
#include <string>
#include <sys/file.h>
#include <sys/resource.h>
#include <thread>
#include <unistd.h>
#include <vector>

#include "core/monitor.h"
#include "printing/slicers/child_process.h"
#include "tests/support/temporary_folder.h"

// Processes that are forked from a copy of this one, which has no threads when the copy is made.
namespace aerate {
namespace {

namespace fs = std::filesystem;

void wait_for(const fs::path& file) {
  while (!fs::exists(file)) std::this_thread::sleep_for(std::chrono::milliseconds(5));
}

// "sizes WORD...": says how long each is; "wait BEGUN GATE": until the second file is there.
int test_main(int argc, char* const* argv) {
  const std::vector<std::string> words(argv, argv + argc);
  if (words[1] == "sizes")
    for (int i = 2; i < argc; ++i) std::cout << words[static_cast<std::size_t>(i)].size() << " ";
  if (words[1] != "wait") return 0;
  std::ofstream(words[2]) << "";
  wait_for(words[3]);
  return 7;
}

ChildOutcome run(const OwnCommands& commands, std::vector<std::string> words, int held = -1) {
  Monitor monitor;
  const PrivateFolder folder(monitor);
  words.insert(words.begin(), "test");
  ChildCommand command;
  command.arguments = std::move(words);
  command.folder = folder.path();
  command.held = held;
  return commands.run(command, monitor);
}

TEST(OwnCommands, ArgumentsOfAnyLengthArriveWhole) {
  const OwnCommands commands(test_main);
  const ChildOutcome outcome =
      run(commands, {"sizes", "", std::string(3'000'000, 'a'), "line\nfeed", std::string(70, '\xfc')});
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_EQ(outcome.printed, "0 3000000 9 70 ");
}

TEST(OwnCommands, MoreRunAtATimeThanTheUsualBoundOfDescriptorsHasRoomFor) {
  rlimit usual{};
  ASSERT_EQ(getrlimit(RLIMIT_NOFILE, &usual), 0);
  rlimit few = usual;
  few.rlim_cur = 64;
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &few), 0);
  constexpr std::size_t kMany = 60;
  const test::TemporaryFolder folder;
  std::vector<int> exit_codes(kMany);
  {
    const OwnCommands commands(test_main);
    std::vector<std::jthread> threads;
    for (std::size_t i = 0; i < kMany; ++i)
      threads.emplace_back([&, i] {
        exit_codes[i] =
            run(commands, {"wait", folder.path() / std::to_string(i), folder.path() / "gate"}).exit_code;
      });
    for (std::size_t i = 0; i < kMany; ++i) wait_for(folder.path() / std::to_string(i));
    std::ofstream(folder.path() / "gate") << "";
  }
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &usual), 0);
  EXPECT_EQ(exit_codes, std::vector<int>(kMany, 7));
}

// As the lock of a folder that a killed batch worked in.
TEST(OwnCommands, WhatIsHeldIsHeldUntilTheProcessHasEnded) {
  const test::TemporaryFolder folder;
  const fs::path lock = folder.path() / "lock", begun = folder.path() / "begun",
                 gate = folder.path() / "gate";
  const auto opened = [&] { return open(lock.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600); };
  const OwnCommands commands(test_main);
  const int held = opened(), other = opened();
  ASSERT_EQ(flock(held, LOCK_EX | LOCK_NB), 0);
  {
    const std::jthread thread([&] { EXPECT_EQ(run(commands, {"wait", begun, gate}, held).exit_code, 7); });
    wait_for(begun);
    close(held);
    EXPECT_NE(flock(other, LOCK_EX | LOCK_NB), 0);
    std::ofstream(gate) << "";
  }
  EXPECT_EQ(flock(other, LOCK_EX), 0);
  close(other);
}

}  // namespace
}  // namespace aerate
