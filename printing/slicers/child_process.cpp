#include "printing/slicers/child_process.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <climits>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <fstream>
#include <iostream>
#include <mutex>
#include <optional>
#include <poll.h>
#include <span>
#include <string_view>
#include <sys/file.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <sys/wait.h>
#include <system_error>
#include <unistd.h>
#include <utility>

#include "core/error.h"
#include "files/output_file.h"
#include "printing/slicers/text_file.h"

namespace aerate {
namespace {

namespace fs = std::filesystem;

constexpr mode_t kOwnerOnly = 0600;

std::vector<char*> pointers_to(std::vector<std::string>& strings) {
  std::vector<char*> pointers;
  pointers.reserve(strings.size() + 1);
  for (std::string& string : strings) pointers.push_back(string.data());
  pointers.push_back(nullptr);
  return pointers;
}

bool is_called(std::string_view variable, std::string_view pattern) {
  if (pattern.ends_with('*')) return variable.starts_with(pattern.substr(0, pattern.size() - 1));
  return variable == pattern;
}

std::vector<std::string> environment_of(const ChildCommand& command) {
  std::vector<std::string> variables;
  for (char** variable = environ; *variable != nullptr; ++variable) {
    const std::string_view text = *variable, called = text.substr(0, text.find('='));
    const bool is_replaced =
        std::ranges::any_of(command.environment, [&](const auto& added) { return added.first == called; });
    const bool is_left_out = std::ranges::any_of(
        command.without, [&](const std::string& pattern) { return is_called(called, pattern); });
    if (!is_replaced && !is_left_out) variables.emplace_back(text);
  }
  for (const auto& [name, value] : command.environment)
    variables.push_back(std::string(name).append("=").append(value));
  return variables;
}

void close_if_open(int& descriptor) {
  if (descriptor >= 0) ::close(std::exchange(descriptor, -1));
}

// Both ends are closed in programs that are started.
struct Pipe {
  Pipe() {
    std::array<int, 2> ends{};
    if (::pipe2(ends.data(), O_CLOEXEC) != 0)
      throw FailureError("no pipe can be made: " + std::generic_category().message(errno));
    reads = ends[0];
    writes = ends[1];
  }
  ~Pipe() {
    close_if_open(reads);
    close_if_open(writes);
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;

  int reads = -1, writes = -1;
};

// What a keeper tells: why the program could not be started (errno), or how it ended (a status of wait).
struct KeeperReport {
  int error = 0;
  int status = 0;
};

void report_failure(int report_to, int error) {
  const KeeperReport failure{.error = error, .status = 0};
  [[maybe_unused]] const ssize_t written = ::write(report_to, &failure, sizeof(failure));
}

// All that is needed between fork and exec, made before: nothing there may allocate.
struct Start {
  std::vector<std::string> arguments, variables;
  std::string answers, printed;
  CommandMain own = nullptr;  // what is run instead of a program's file
  std::vector<char*> argv = pointers_to(arguments), envp = pointers_to(variables);
};

// Without loading this program anew. Of a process that had one thread, so that this may do anything.
[[noreturn]] void run_own(const Start& start, int report_to) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGCHLD}) ::signal(signal, SIG_DFL);
  ::prctl(PR_SET_NAME, "aerate-job");  // for who looks for what keeps the machine busy
  ::close(report_to);                  // open in the keeper alone, whose end is seen by it
  const int status = start.own(static_cast<int>(start.arguments.size()), start.argv.data());
  std::cout.flush();
  std::cerr.flush();
  // Without what is done at an exit: libraries wait there for threads that they started when they were loaded, which a copy has not.
  ::_exit(status);
}

[[noreturn]] void become_program(const Start& start, pid_t keeper, int report_to) {
  ::setpgid(0, 0);
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != keeper) ::_exit(1);  // it ended before
  const int in = ::open(start.answers.c_str(), O_RDONLY | O_CLOEXEC);
  const int out =
      ::open(start.printed.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_TRUNC | O_CLOEXEC, kOwnerOnly);
  if (in >= 0 && out >= 0 && ::dup2(in, STDIN_FILENO) >= 0 && ::dup2(out, STDOUT_FILENO) >= 0 &&
      ::dup2(out, STDERR_FILENO) >= 0) {
    if (start.own != nullptr) run_own(start, report_to);
    ::execvpe(start.argv[0], start.argv.data(), start.envp.data());
  }
  report_failure(report_to, errno);
  ::_exit(1);
}

// Tells when a process has ended; negative where the system has no such descriptors (Linux before 5.3).
int opened_process(pid_t process) {
  return static_cast<int>(::syscall(SYS_pidfd_open, process, 0));
}

// Waits for the program, and ends it with all it started as soon as nobody holds the other end of `life`: the
// process that wanted it is gone, be it by SIGKILL.
[[noreturn]] void keep(pid_t program, int life, int report_to) {
  constexpr int kPollMilliseconds = 10;
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT}) ::signal(signal, SIG_IGN);
  KeeperReport report;
  const int end_of_program = opened_process(program);
  std::array<pollfd, 2> watched{pollfd{life, POLLIN, 0},
                                pollfd{end_of_program, POLLIN, 0}};  // poll skips negative ones
  for (;;) {
    if (::waitpid(program, &report.status, WNOHANG) == program) break;
    ::poll(watched.data(), watched.size(), kPollMilliseconds);
    if (watched[0].revents == 0) continue;
    ::kill(-program, SIGKILL);
    ::kill(program, SIGKILL);  // if it leads no group yet
    ::waitpid(program, &report.status, 0);
    ::_exit(0);
  }
  [[maybe_unused]] const ssize_t written = ::write(report_to, &report, sizeof(report));
  ::_exit(0);
}

// The forked process that has the program as its child. Only calls that are safe after the fork of a process
// with threads.
[[noreturn]] void become_keeper(const Start& start, int life, int report_to) {
  ::setpgid(0, 0);  // out of reach of the terminal's signals
  const pid_t keeper = ::getpid();
  const pid_t program = ::fork();
  if (program == 0) become_program(start, keeper, report_to);
  if (program < 0) {
    report_failure(report_to, errno);
    ::_exit(1);
  }
  keep(program, life, report_to);
}

FailureError cannot_be_run(const std::string& name, int error) {
  return FailureError(name + ": cannot be run: " + std::generic_category().message(error));
}

// Until the program has ended; its exit status, or 128 + the signal that ended it.
int awaited(int reports, const std::string& name, Monitor& monitor) {
  constexpr int kPollMilliseconds = 10;
  pollfd watched{reports, POLLIN, 0};
  while (::poll(&watched, 1, kPollMilliseconds) <= 0) monitor.check_interrupted();
  KeeperReport report;
  if (::read(reports, &report, sizeof(report)) != sizeof(report))
    throw FailureError("a started program cannot be waited for");
  if (report.error != 0) throw cannot_be_run(name, report.error);
  return WIFEXITED(report.status) ? WEXITSTATUS(report.status) : 128 + WTERMSIG(report.status);
}

// A program that leads a process group, with its standard streams from and to files, and a keeper beside it. It
// is ended, and whatever it started, when this object or this process ends.
class RunningChild {
 public:
  RunningChild(const Start& start, Monitor& monitor,
               const std::unique_lock<std::mutex>& /*one_at_a_time*/ = starting())
      : name_(start.arguments.front()), monitor_(monitor) {
    keeper_ = ::fork();
    if (keeper_ == 0) {
      ::close(life_.writes);
      ::close(reports_.reads);
      become_keeper(start, life_.reads, reports_.writes);
    }
    if (keeper_ < 0) throw cannot_be_run(name_, errno);
    close_if_open(life_.reads);
    close_if_open(reports_.writes);
  }
  ~RunningChild() {
    close_if_open(life_.writes);
    while (::waitpid(keeper_, nullptr, 0) < 0 && errno == EINTR) {
    }
  }
  RunningChild(const RunningChild&) = delete;
  RunningChild& operator=(const RunningChild&) = delete;

  int wait() { return awaited(reports_.reads, name_, monitor_); }

 private:
  // Pipes are made and ends closed while no other thread forks: keepers have the ends of those only that were started before them, so that
  // all see the end of this process, the last one first.
  static std::unique_lock<std::mutex> starting() {
    static std::mutex mutex;
    return std::unique_lock(mutex);
  }

  std::string name_;
  Monitor& monitor_;
  Pipe life_, reports_;
  pid_t keeper_ = -1;
};

constexpr std::string_view kFolderPrefix = "aerate-";
constexpr const char* kLockName = "lock";

// Locked for as long as this process lives, or a child that it forked. Made under another name, so that one of
// the right name is never without its lock. Negative if it cannot be made.
int made_lock(const fs::path& folder) {
  const fs::path unlocked = folder / "lock.new";
  int descriptor = ::open(unlocked.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, kOwnerOnly);
  if (descriptor < 0) return -1;
  if (::flock(descriptor, LOCK_EX | LOCK_NB) != 0 ||
      ::rename(unlocked.c_str(), (folder / kLockName).c_str()) != 0)
    close_if_open(descriptor);
  return descriptor;
}

bool is_own_folder(const fs::path& path) {
  struct stat facts {};
  return ::lstat(path.c_str(), &facts) == 0 && S_ISDIR(facts.st_mode) && facts.st_uid == ::geteuid() &&
         (facts.st_mode & (S_IRWXG | S_IRWXO)) == 0;
}

// Removes the folder of a process that ended without doing so: its lock is there, and nobody holds it.
void remove_if_left(const fs::path& folder) {
  if (!folder.filename().string().starts_with(kFolderPrefix) || !is_own_folder(folder)) return;
  int lock = ::open((folder / kLockName).c_str(), O_RDWR | O_CLOEXEC | O_NOFOLLOW);
  if (lock < 0) return;
  std::error_code ignored;
  if (::flock(lock, LOCK_EX | LOCK_NB) == 0) fs::remove_all(folder, ignored);
  close_if_open(lock);
}

void remove_folders_left_in(const fs::path& base) {
  std::error_code ignored;
  for (fs::directory_iterator entry(base, ignored), end; !ignored && entry != end; entry.increment(ignored))
    remove_if_left(entry->path());
}

// What a program reads and where what it prints goes.
struct Streams {
  explicit Streams(const ChildCommand& command)
      : answers(command.folder / "answers"), printed(command.folder / "printed") {
    std::ofstream(answers) << "y\n";
  }

  fs::path answers, printed;
};

// The descriptors that go with a request: the end of a keeper's life, where it reports to, and what it holds, if anything.
constexpr std::size_t kMostDescriptors = 3;

// One message of a socket: a short text, and room for descriptors.
class Message {
 public:
  Message(char* text, std::size_t size) : part_{text, size} {
    header_.msg_iov = &part_;
    header_.msg_iovlen = 1;
    header_.msg_control = control_.data();
    header_.msg_controllen = control_.size();
  }
  Message(const Message&) = delete;
  Message& operator=(const Message&) = delete;

  msghdr& header() { return header_; }
  cmsghdr* descriptors() { return CMSG_FIRSTHDR(&header_); }

 private:
  iovec part_;
  alignas(cmsghdr) std::array<char, CMSG_SPACE(kMostDescriptors * sizeof(int))> control_{};
  msghdr header_{};
};

// The request is a file's name, since a socket takes no message of any length.
void send_request(int socket, std::string file, std::span<const int> descriptors) {
  Message message(file.data(), file.size());
  cmsghdr* const header = message.descriptors();
  header->cmsg_level = SOL_SOCKET;
  header->cmsg_type = SCM_RIGHTS;
  header->cmsg_len = CMSG_LEN(descriptors.size_bytes());
  message.header().msg_controllen = CMSG_SPACE(descriptors.size_bytes());
  std::memcpy(CMSG_DATA(header), descriptors.data(), descriptors.size_bytes());
  while (::sendmsg(socket, &message.header(), MSG_NOSIGNAL) < 0)
    if (errno != EINTR) throw cannot_be_run("a process", errno);
}

struct Request {
  fs::path file;
  std::vector<int> descriptors;
};

// Nothing at the end of those who ask.
std::optional<Request> received_request(int socket) {
  std::array<char, PATH_MAX> file{};
  Message message(file.data(), file.size());
  ssize_t size = -1;
  while ((size = ::recvmsg(socket, &message.header(), MSG_CMSG_CLOEXEC)) < 0 && errno == EINTR) {
  }
  const cmsghdr* const header = message.descriptors();
  if (size <= 0 || header == nullptr) return std::nullopt;
  std::vector<int> descriptors((header->cmsg_len - CMSG_LEN(0)) / sizeof(int));
  std::memcpy(descriptors.data(), CMSG_DATA(header), descriptors.size() * sizeof(int));
  return Request{{file.data(), file.data() + size}, std::move(descriptors)};
}

// Each with a zero after it.
std::string text_of(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text.append(word).push_back('\0');
  return text;
}

std::vector<std::string> words_in(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::vector<std::string> words;
  for (std::string word; std::getline(stream, word, '\0');) words.push_back(word);
  return words;
}

// Two for each process that is waited for, where the system's usual bound is 1024.
void allow_many_descriptors() {
  constexpr rlim_t kMany = 4096;
  rlimit bounds{};
  if (::getrlimit(RLIMIT_NOFILE, &bounds) != 0 || bounds.rlim_cur >= kMany) return;
  bounds.rlim_cur = std::min(kMany, bounds.rlim_max);
  ::setrlimit(RLIMIT_NOFILE, &bounds);
}

// Takes leave of keepers that have ended. Not by ignoring the signal: the processor time of all is to be this one's.
void bury(int /*signal*/) {
  const int error = errno;
  while (::waitpid(-1, nullptr, WNOHANG) > 0) {
  }
  errno = error;
}

// The process that forks one for each request, for as long as somebody may ask. It has one thread.
[[noreturn]] void start_what_is_asked_for(int requests, CommandMain main) {
  ::setpgid(0, 0);  // out of reach of the terminal's signals
  ::signal(SIGCHLD, bury);
  while (auto request = received_request(requests)) {
    std::vector<int>& descriptors = request->descriptors;
    const int life = descriptors[0], report_to = descriptors[1];
    std::vector<std::string> words = words_in(request->file);
    Start start{.arguments = {words.begin() + 2, words.end()},
                .variables = {},
                .answers = words[0],
                .printed = words[1],
                .own = main};
    const pid_t keeper = ::fork();
    if (keeper == 0) {
      ::close(requests);
      ::signal(SIGCHLD, SIG_DFL);
      become_keeper(start, life, report_to);
    }
    if (keeper < 0) report_failure(report_to, errno);
    for (int& descriptor : descriptors) close_if_open(descriptor);
  }
  while (::waitpid(-1, nullptr, 0) > 0 || errno == EINTR) {
  }
  ::_exit(0);
}

}  // namespace

PrivateFolder::PrivateFolder(Monitor& monitor) : monitor_(monitor) {
  // Not temp_directory_path, which does not say which path it could not use.
  const char* given = std::getenv("TMPDIR");
  const fs::path base = given != nullptr && *given != '\0' ? given : "/tmp";
  remove_folders_left_in(base);
  std::string pattern = (fs::absolute(base) / (std::string(kFolderPrefix) + "XXXXXX")).string();
  if (::mkdtemp(pattern.data()) == nullptr) {
    const int error = errno;
    throw FailureError(
        "no temporary folder can be made in " + base.string() + ": " + std::generic_category().message(error),
        "set TMPDIR to a folder with free space");
  }
  path_ = pattern;
  lock_ = made_lock(path_);
  monitor_.temporary_file_made(path_);
}

PrivateFolder::~PrivateFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
  close_if_open(lock_);
  monitor_.temporary_file_gone(path_);
}

ChildOutcome run_child(const ChildCommand& command, Monitor& monitor) {
  const Streams streams(command);
  const Start start{.arguments = command.arguments,
                    .variables = environment_of(command),
                    .answers = streams.answers,
                    .printed = streams.printed};
  RunningChild child(start, monitor);
  const int exit_code = child.wait();
  return {exit_code, read_text(streams.printed)};
}

OwnCommands::OwnCommands(CommandMain main) {
  std::array<int, 2> ends{};
  if (::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends.data()) != 0)
    throw FailureError("no socket can be made: " + std::generic_category().message(errno));
  starter_ = ::fork();
  if (starter_ == 0) {
    ::close(ends[0]);
    start_what_is_asked_for(ends[1], main);
  }
  const int error = errno;
  ::close(ends[1]);
  requests_ = ends[0];
  if (starter_ < 0) {
    ::close(requests_);
    throw cannot_be_run("a process", error);
  }
  allow_many_descriptors();
}

OwnCommands::~OwnCommands() {
  close_if_open(requests_);
  while (::waitpid(starter_, nullptr, 0) < 0 && errno == EINTR) {
  }
}

ChildOutcome OwnCommands::run(const ChildCommand& command, Monitor& monitor) const {
  const Streams streams(command);
  Pipe life, reports;
  std::vector<std::string> words{streams.answers, streams.printed};
  words.insert(words.end(), command.arguments.begin(), command.arguments.end());
  const fs::path request = command.folder / "request";
  write_bytes(text_of(words), request);
  std::vector<int> descriptors{life.reads, reports.writes};
  if (command.held >= 0) descriptors.push_back(command.held);
  send_request(requests_, fs::absolute(request), descriptors);
  close_if_open(life.reads);
  close_if_open(reports.writes);
  const auto end = [&] {  // which its keeper's is the last of
    close_if_open(life.writes);
    KeeperReport ignored;
    while (::read(reports.reads, &ignored, sizeof(ignored)) > 0 || errno == EINTR) errno = 0;
  };
  try {
    const int exit_code = awaited(reports.reads, command.arguments.front(), monitor);
    end();
    return {exit_code, read_text(streams.printed)};
  } catch (const InterruptedError&) {
    end();
    throw;
  }
}

}  // namespace aerate
