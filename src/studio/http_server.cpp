#include "studio/http_server.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <fcntl.h>
#include <fmt/format.h>
#include <httplib.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <system_error>
#include <thread>
#include <unistd.h>
#include <utility>

#include "core/error.h"
#include "studio/api.h"

namespace aerate::studio {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr std::size_t kMostHeadBytes = 32 << 10;
constexpr seconds kHeadPatience{10};   // for a whole head
constexpr seconds kPiecePatience{30};  // for some bytes of a body, or some that are taken
constexpr seconds kLinger{2};          // for who still sends when it is answered
constexpr milliseconds kGlance{200};   // between looks at whether to end
constexpr milliseconds kBetweenEvents{100};
constexpr seconds kSignOfLife{10};
constexpr int kQueue = 16;  // threads beside those of listeners

// A connection, read and written with patience that ends, and with a head that is bounded.
class Connection final : public httplib::Stream {
 public:
  Connection(socket_t socket, const std::atomic<bool>& is_ending) : socket_(socket), is_ending_(is_ending) {}

  void head_is_read() { is_in_head_ = false; }

  bool is_readable() const override { return waits(POLLIN, kPiecePatience); }
  // By whom what is written would be read.
  bool is_writable() const override {
    char byte = 0;
    const bool is_closed = ::recv(socket_, &byte, 1, MSG_PEEK | MSG_DONTWAIT) == 0;
    return !is_closed && !is_ending_ && waits(POLLOUT, kPiecePatience);
  }

  ssize_t read(char* into, std::size_t most) override {
    if (begin_ == end_ && !fill()) return -1;
    const std::size_t count = std::min(most, end_ - begin_);
    std::memcpy(into, buffer_.data() + begin_, count);
    begin_ += count;
    return static_cast<ssize_t>(count);
  }

  ssize_t write(const char* bytes, std::size_t count) override {
    if (!waits(POLLOUT, kPiecePatience)) return -1;
    while (true) {
      const ssize_t sent = ::send(socket_, bytes, count, MSG_NOSIGNAL);
      if (sent >= 0 || errno != EINTR) return sent;
    }
  }

  void get_remote_ip_and_port(std::string& /*ip*/, int& /*port*/) const override {}
  void get_local_ip_and_port(std::string& /*ip*/, int& /*port*/) const override {}
  socket_t socket() const override { return socket_; }

  // Reads on for a while, so that an answer is not lost to one who still sends.
  void close() {
    ::shutdown(socket_, SHUT_WR);
    const auto end = Clock::now() + kLinger;
    while (!is_ending_ && Clock::now() < end && waits(POLLIN, milliseconds(kGlance))) {
      if (::recv(socket_, buffer_.data(), buffer_.size(), MSG_DONTWAIT) <= 0) break;
    }
    ::close(socket_);
  }

 private:
  bool waits(short what, milliseconds patience) const {
    const auto end = Clock::now() + patience;
    while (!is_ending_) {
      pollfd polled{socket_, what, 0};
      const int ready = ::poll(&polled, 1, static_cast<int>(kGlance.count()));
      if (ready > 0) return (polled.revents & (what | POLLHUP)) != 0;
      if ((ready < 0 && errno != EINTR) || Clock::now() >= end) return false;
    }
    return false;
  }

  bool fill() {
    const auto patience =
        is_in_head_ ? std::chrono::duration_cast<milliseconds>(begin_of_head_ + kHeadPatience - Clock::now())
                    : milliseconds(kPiecePatience);
    const std::size_t most = is_in_head_ ? kMostHeadBytes - head_bytes_ : buffer_.size();
    if (patience.count() <= 0 || most == 0 || !waits(POLLIN, patience)) return false;
    const ssize_t count = ::recv(socket_, buffer_.data(), std::min(most, buffer_.size()), 0);
    if (count <= 0) return false;
    begin_ = 0;
    end_ = static_cast<std::size_t>(count);
    if (is_in_head_) head_bytes_ += end_;
    return true;
  }

  const socket_t socket_;
  const std::atomic<bool>& is_ending_;
  const Clock::time_point begin_of_head_ = Clock::now();
  bool is_in_head_ = true;
  std::size_t head_bytes_ = 0;
  std::array<char, 64 << 10> buffer_;
  std::size_t begin_ = 0, end_ = 0;
};

// A file that is sent as it was when it was opened.
class OpenFile {
 public:
  explicit OpenFile(const std::filesystem::path& path) : file_(::open(path.c_str(), O_RDONLY | O_CLOEXEC)) {
    struct stat found {};
    if (file_ >= 0 && ::fstat(file_, &found) == 0) bytes_ = static_cast<std::size_t>(found.st_size);
  }
  ~OpenFile() {
    if (file_ >= 0) ::close(file_);
  }
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;

  bool is_there() const { return file_ >= 0; }
  std::size_t bytes() const { return bytes_; }

  bool send(std::size_t from, std::size_t count, httplib::DataSink& sink) const {
    std::array<char, 64 << 10> piece;
    const ssize_t got = ::pread(file_, piece.data(), std::min(count, piece.size()), static_cast<off_t>(from));
    return got > 0 && sink.write(piece.data(), static_cast<std::size_t>(got));
  }

 private:
  int file_;
  std::size_t bytes_ = 0;
};

std::optional<std::string> header(const httplib::Request& request, const char* name) {
  if (!request.has_header(name)) return std::nullopt;
  return request.get_header_value(name);
}

constexpr std::array kHeadersOnce{"Host",         "Origin",           "Sec-Fetch-Site", "Authorization",
                                  "Content-Type", "Content-Encoding", "Content-Length", "Transfer-Encoding"};

bool is_ambiguous(const httplib::Request& request) {
  const bool is_double = std::ranges::any_of(
      kHeadersOnce, [&](const char* name) { return request.get_header_value_count(name) > 1; });
  return is_double || (request.has_header("Content-Length") && request.has_header("Transfer-Encoding"));
}

RequestHead head_of(const httplib::Request& request) {
  return {request.method,
          request.path,
          header(request, "Host"),
          header(request, "Origin"),
          header(request, "Sec-Fetch-Site"),
          header(request, "Authorization"),
          header(request, "Content-Type"),
          header(request, "Content-Encoding"),
          header(request, "Content-Length")};
}

httplib::Headers headers_of_all() {
  return {{"Content-Security-Policy",
           "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; img-src 'self' "
           "blob: data:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"},
          {"X-Content-Type-Options", "nosniff"},
          {"Referrer-Policy", "no-referrer"},
          {"Cross-Origin-Resource-Policy", "same-origin"},
          {"Cross-Origin-Opener-Policy", "same-origin"},
          {"Cache-Control", "no-store"}};
}

}  // namespace

class HttpServer::Listener final : public httplib::Server {
 public:
  Listener(Studio& studio, const std::string& host, int port, std::string token) : studio_(studio) {
    new_task_queue = [this] { return new httplib::ThreadPool(studio_.bounds().listeners + kQueue); };
    set_keep_alive_max_count(1);
    set_default_headers(headers_of_all());
    // Not SO_REUSEPORT, by which another program could share the port.
    set_socket_options([](socket_t socket) {
      const int yes = 1;
      ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    });
    errno = 0;
    const bool is_bound = port == 0 ? (port = bind_to_any_port(host)) > 0 : bind_to_port(host, port);
    if (!is_bound) refuse_port(host, port);
    guard_ = {{host, port}, std::move(token), studio_.bounds().body_bytes};
    route();
    thread_ = std::thread([this] { listen_after_bind(); });
    while (!is_running()) std::this_thread::sleep_for(milliseconds(1));
  }

  ~Listener() override {
    is_ending_ = true;
    stop();
    thread_.join();
  }
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;

  const Guard& guard() const { return guard_; }

 private:
  [[noreturn]] static void refuse_port(const std::string& host, int port) {
    const std::string why = errno == 0 ? "the system says not why" : std::generic_category().message(errno);
    if (port <= 0)
      throw UsageError(fmt::format("--host {} cannot be had: {}", host, why), "leave out --host");
    throw UsageError(fmt::format("--port {} of {} cannot be had: {}", port, host, why),
                     "leave out --port, and a free one is taken; or give another");
  }

  bool process_and_close_socket(socket_t socket) override {
    Connection connection(socket, is_ending_);
    bool is_closed = false;
    const auto begin = [&](httplib::Request& request) {
      connection.head_is_read();
      request.ranges.clear();  // files are sent whole
    };
    const bool is_done = process_request(connection, true, is_closed, begin);
    connection.close();
    return is_done;
  }

  std::optional<Refusal> refusal_of(const httplib::Request& request) const {
    if (is_ambiguous(request)) return Refusal{400, "a header is there twice", ""};
    return guard_.refusal_of(head_of(request));
  }

  void route() {
    set_expect_100_continue_handler([this](const httplib::Request& request, httplib::Response& response) {
      const auto refusal = refusal_of(request);
      if (!refusal) return 100;
      put(answer_to(*refusal), response);
      return refusal->status;
    });
    set_pre_routing_handler([this](const httplib::Request& request, httplib::Response& response) {
      const auto refusal = refusal_of(request);
      if (!refusal) return HandlerResponse::Unhandled;
      put(answer_to(*refusal), response);
      return HandlerResponse::Handled;
    });
    set_error_handler([](const httplib::Request&, httplib::Response& response) {
      if (!response.body.empty()) return;
      const Answer answer = answer_to({response.status, "the request was not understood", ""});
      response.set_content(answer.body, answer.type);
    });
    Get(".*", [this](const httplib::Request& request, httplib::Response& response) {
      put(answer(studio_, of(request), [](const auto&) { return true; }), response);
    });
    Post(".*", [this](const httplib::Request& request, httplib::Response& response,
                      const httplib::ContentReader& content) {
      const auto body = [&](const std::function<bool(std::string_view)>& take) {
        return content([&](const char* bytes, std::size_t count) { return take({bytes, count}); });
      };
      put(answer(studio_, of(request), body), response);
    });
  }

  static ApiRequest of(const httplib::Request& request) {
    return {request.method, request.path, request.has_param("name") ? request.get_param_value("name") : ""};
  }

  void put(const Answer& answer, httplib::Response& response) {
    response.status = answer.status;
    if (answer.is_event_stream) {
      put_events(response);
    } else if (answer.file) {
      put_file(answer, response);
    } else {
      response.set_content(answer.body, answer.type);
    }
  }

  void put_file(const Answer& answer, httplib::Response& response) {
    const auto file = std::make_shared<OpenFile>(answer.file->path);
    if (!file->is_there()) {
      put(answer_to({404, "the file is gone", ""}), response);
      return;
    }
    if (answer.is_to_save) response.set_header("Content-Disposition", attachment_called(answer.file->name));
    response.set_content_provider(file->bytes(), answer.type,
                                  [file](std::size_t from, std::size_t count, httplib::DataSink& sink) {
                                    return file->send(from, count, sink);
                                  });
  }

  void put_events(httplib::Response& response) {
    if (++listeners_ > studio_.bounds().listeners) {
      --listeners_;
      put(answer_to({429, fmt::format("{} tabs listen, and no more can", studio_.bounds().listeners),
                     "close one of them"}),
          response);
      return;
    }
    struct Heard {
      std::uint64_t moment = 0;
      Clock::time_point last = Clock::now();
    };
    const auto heard = std::make_shared<Heard>();
    const auto send = [this, heard](std::size_t, httplib::DataSink& sink) {
      const Changes changes = studio_.changes_after(heard->moment, kGlance);
      std::string text = events_of(changes);
      const bool is_quiet = Clock::now() - heard->last >= kSignOfLife;
      heard->moment = changes.moment;
      if (text.empty() && is_quiet) text = ": here\n\n";
      if (text.empty()) return !is_ending_ && sink.is_writable();
      heard->last = Clock::now();
      if (!sink.write(text.data(), text.size())) return false;
      std::this_thread::sleep_for(kBetweenEvents);
      return !is_ending_.load();
    };
    response.set_chunked_content_provider("text/event-stream", send, [this](bool) { --listeners_; });
  }

  Studio& studio_;
  Guard guard_;
  std::atomic<bool> is_ending_ = false;
  std::atomic<std::size_t> listeners_ = 0;
  std::thread thread_;
};

HttpServer::HttpServer(Studio& studio, const std::string& host, int port, std::string token)
    : listener_(std::make_unique<Listener>(studio, host, port, std::move(token))) {}

HttpServer::~HttpServer() = default;

const ServedAt& HttpServer::at() const {
  return listener_->guard().at;
}

std::string HttpServer::address() const {
  return at().origin() + "/#" + listener_->guard().token;
}

}  // namespace aerate::studio
