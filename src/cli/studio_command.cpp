#include <CLI/CLI.hpp>
#include <arpa/inet.h>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <fcntl.h>
#include <fmt/format.h>
#include <fstream>
#include <iostream>
#include <memory>
#include <optional>
#include <spawn.h>
#include <string>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>
#include <vector>

#include "cli/commands.h"
#include "cli/interrupt.h"
#include "cli/numbers.h"
#include "cli/studio_plan.h"
#include "cli/terminal.h"
#include "core/error.h"
#include "files/formats.h"
#include "files/input_file.h"
#include "studio/guard.h"
#include "studio/http_server.h"
#include "studio/private_folder.h"
#include "studio/refusal.h"
#include "studio/studio.h"
#include "view/built_files.h"

namespace aerate::cli {
namespace {

namespace fs = std::filesystem;

constexpr const char* kHere = "127.0.0.1";

bool is_address(const std::string& host) {
  in6_addr address{};
  return ::inet_pton(AF_INET, host.c_str(), &address) == 1 ||
         ::inet_pton(AF_INET6, host.c_str(), &address) == 1;
}

// As browsers write it: "0::1" -> "::1". An address.
std::string shortest(const std::string& host) {
  char text[INET6_ADDRSTRLEN] = "";
  in6_addr address{};
  const int family = ::inet_pton(AF_INET6, host.c_str(), &address) == 1 ? AF_INET6 : AF_INET;
  if (family == AF_INET) ::inet_pton(AF_INET, host.c_str(), &address);
  return ::inet_ntop(family, &address, text, sizeof text);
}

bool is_of_this_machine(const std::string& host) {
  return host.starts_with("127.") || host == "::1";
}

// "512", "512M", "2G": bytes
std::optional<std::uint64_t> parse_size(std::string_view text) {
  double unit = 1;
  if (!text.empty()) {
    const std::size_t at = std::string_view("kMG").find(text.back());
    if (at != std::string_view::npos) {
      unit = at == 0 ? 1e3 : at == 1 ? 1e6 : 1e9;
      text.remove_suffix(1);
    }
  }
  constexpr double kMost = 1e12;
  const auto number = parse_number(text);
  if (!number || *number * unit < 1 || *number * unit > kMost) return std::nullopt;
  return static_cast<std::uint64_t>(*number * unit);
}

// Empty if it is not set.
std::string environment(const char* name) {
  const char* const value = std::getenv(name);
  return value != nullptr ? value : "";
}

// The program that opens a page, if there is somebody to look at it.
std::optional<std::string> browser() {
  if (const std::string named = environment("BROWSER"); !named.empty())
    return named.substr(0, named.find(':'));
  if (!environment("DISPLAY").empty() || !environment("WAYLAND_DISPLAY").empty()) return "xdg-open";
  return std::nullopt;
}

// A page that leads to the address: command lines are for everybody to read, and this file is not.
fs::path page_that_leads_to(const std::string& address, const fs::path& folder) {
  fs::path page = folder / "open.html";
  studio::write_private_file(
      page,
      fmt::format("<!doctype html><meta charset=utf-8><meta http-equiv=refresh "
                  "content=\"0;url={0}\"><title>aerate studio</title><a href=\"{0}\">aerate studio</a>\n",
                  address));
  return page;
}

// Not waited for; whether it works out is seen by who sits there.
void open_browser(const std::string& program, const fs::path& page) {
  std::string path = page.string();
  std::string name = program;
  std::vector<char*> arguments{name.data(), path.data(), nullptr};
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  for (const int output : {STDOUT_FILENO, STDERR_FILENO})
    posix_spawn_file_actions_addopen(&actions, output, "/dev/null", O_WRONLY, 0);
  pid_t child = 0;
  const int failure = ::posix_spawnp(&child, name.c_str(), &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (failure == 0) std::thread([child] { ::waitpid(child, nullptr, 0); }).detach();
}

// A file of the user's, as if it had been sent.
void load(studio::Studio& studio, const fs::path& path) {
  check_readable(path);
  try {
    auto upload = studio.begin_upload(path.filename().string());
    std::ifstream file(path, std::ios::binary);
    std::string piece(std::size_t{1} << 20, '\0');
    while (file.read(piece.data(), static_cast<std::streamsize>(piece.size())) || file.gcount() > 0)
      upload->write({piece.data(), static_cast<std::size_t>(file.gcount())});
    if (file.bad())
      throw InputError(fmt::format("{}: it cannot be read to its end", path.string()), kCopyAgain);
    studio.take(std::move(upload));
  } catch (const studio::Refused& refused) {
    const studio::Refusal& refusal = refused.refusal();
    const auto code = refusal.exit ? static_cast<ExitCode>(*refusal.exit) : ExitCode::usage;
    throw Error(code, refusal.what, refusal.hint);
  }
}

void open_if_possible(const std::string& program, const std::string& address, const fs::path& folder) {
  try {
    open_browser(program, page_that_leads_to(address, folder));
  } catch (const FailureError& error) {
    print_note(fmt::format("no browser is opened: {}", error.what()));
  }
}

struct StudioCommand {
  explicit StudioCommand(CLI::App& command) {
    command.add_option("MODEL", models, "Models that are there from the start: " + names_that_are_read())
        ->type_name("");
    command.add_option("--port", port, "The port that it is found at (default a free one)")
        ->check(whole_number_between(1, 65535, ""))
        ->type_name("N");
    command
        .add_option("--host", host,
                    "The address that it is found at; another than this machine's own lets others in that "
                    "network see all that is sent, the token among it")
        ->check(parsed_by([](const std::string& text) { return is_address(text); }, "is no IP address"))
        ->type_name("ADDRESS")
        ->capture_default_str();
    command.add_flag("--no-browser", no_browser, "Print the address only, and open no browser");
    command
        .add_option("--max-upload", max_upload,
                    "The largest file of a model that is taken, in bytes, or as 500M or 2G")
        ->check(parsed_by(parse_size, "is no size, as in 500M or 2G"))
        ->type_name("SIZE")
        ->capture_default_str();
    command.add_option("--threads", threads, "Threads to use (default all); results are the same")
        ->check(whole_number_between(1, 1024, "threads"))
        ->type_name("N");
    command.fallthrough();
  }

  void run() const {
    for (const char* file : {"studio.html", "studio.js", "studio.css"})
      if (!built_file(file))
        throw UsageError(
            fmt::format("this program was built without the studio ({})", why_no_built_file(file)),
            "install node 18 or newer and npm (Debian: nodejs npm) and configure the build again, or give it "
            "the built files of a release: cmake -DAERATE_VIEW_PAGE=view.html, with the studio's beside it");
    InterruptGuard interrupt;
    const studio::PrivateFolder folder;
    interrupt.guard(folder.path());
    serve(folder.path(), interrupt);
    interrupt.release(folder.path());
  }

  void serve(const fs::path& folder, const InterruptGuard& interrupt) const {
    studio::Bounds bounds;
    bounds.body_bytes = parse_size(max_upload).value();
    const std::optional<int> most_threads =
        threads ? std::optional(static_cast<int>(*threads)) : std::nullopt;
    studio::Studio studio(lent_to_studio(), bounds, folder, most_threads);
    const std::string at = shortest(host);
    const studio::HttpServer server(studio, at, port ? static_cast<int>(*port) : 0, studio::random_token());
    for (const std::string& model : models) load(studio, model);
    const std::string address = server.address();
    if (!is_of_this_machine(at))
      print_note(
          fmt::format("others than this machine can reach {}: what is sent there is not encrypted, so who "
                      "listens in that network sees the models and the token",
                      at));
    std::cout << address << "\n";
    require_stdout_written();
    print_note("the studio runs until Ctrl-C; nothing is kept then");
    const auto program = no_browser ? std::nullopt : browser();
    if (program) open_if_possible(*program, address, folder);
    while (!interrupt.interrupted()) std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }

  std::vector<std::string> models;
  std::optional<double> port, threads;
  std::string host = kHere;
  bool no_browser = false;
  std::string max_upload = "512M";
};

}  // namespace

void add_studio_command(CLI::App& app, const ConfigFile& /*config*/) {
  CLI::App& command = *app.add_subcommand(
      "studio", "The same in the browser: drop a model, choose limits, hollow it, see and save the result");
  command.callback([job = std::make_shared<StudioCommand>(command)] { job->run(); });
}

}  // namespace aerate::cli
