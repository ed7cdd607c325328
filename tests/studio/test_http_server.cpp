#include <chrono>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <httplib.h>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "core/error.h"
#include "studio/http_server.h"
#include "tests/studio/studio_folder.h"
#include "tests/support/caught.h"
#include "tests/support/raw_socket.h"

namespace aerate::studio {
namespace {

using Json = nlohmann::json;
using test::contains;
using test::RawSocket;

constexpr const char* kToken = "0123456789abcdef0123456789abcdef";

class HttpServerTest : public testing::Test {
 protected:
  static constexpr Bounds kBounds{.body_bytes = 1'000'000, .models = 3, .jobs = 4, .listeners = 2};

  int port() const { return server_->at().port; }
  std::string host() const { return fmt::format("127.0.0.1:{}", port()); }

  httplib::Client client() const {
    httplib::Client client("127.0.0.1", port());
    client.set_default_headers({{"Authorization", std::string("Bearer ") + kToken}});
    return client;
  }
  static std::string block() { return test::to_binary_stl(test::make_box({0, 0, 0}, {30, 30, 30})); }
  Json upload_block() const {
    const auto result = client().Post("/api/models?name=block.stl", block(), "application/octet-stream");
    return Json::parse(result->body);
  }
  Json start(const Json& options) const {
    const auto result =
        client().Post("/api/jobs", Json{{"model", "m1"}, {"options", options}}.dump(), "application/json");
    return Json::parse(result->body);
  }

  // A request whose head says all that has to be said, with further lines.
  std::string head(const std::string& first, const std::string& more = "") const {
    return fmt::format("{} HTTP/1.1\r\nHost: {}\r\nAuthorization: Bearer {}\r\n{}\r\n", first, host(), kToken,
                       more);
  }
  // What is answered to these bytes.
  std::string asked(const std::string& bytes) const {
    const RawSocket socket(port());
    socket.send(bytes);
    return socket.receive();
  }
  int status(const std::string& bytes) const {
    const std::string answer = asked(bytes);
    return answer.starts_with("HTTP/1.1 ") ? std::stoi(answer.substr(9, 3)) : 0;
  }

  StudioFolder folder_{kBounds};
  std::unique_ptr<HttpServer> server_ =
      std::make_unique<HttpServer>(folder_.studio(), "127.0.0.1", 0, kToken);
};

TEST_F(HttpServerTest, TheAddressHasTheTokenWhereItIsNotSent) {
  EXPECT_EQ(server_->address(), fmt::format("http://{}/#{}", host(), kToken));
}

TEST_F(HttpServerTest, DoesAWholeJob) {
  const Json model = upload_block();
  EXPECT_EQ(model["id"], "m1");
  EXPECT_EQ(model["report"]["input"]["triangles"], 12);
  EXPECT_GT(client().Get("/api/models/m1/scene")->body.size(), 100u);
  const auto estimate =
      client().Post("/api/estimate", R"({"model":"m1","options":{"wall":"3"}})", "application/json");
  EXPECT_GT(Json::parse(estimate->body)["removed"]["to"], 0.2);
  EXPECT_EQ(start({{"wall", "3"}})["id"], "j1");
  folder_.wait_for("j1");
  const Json state = Json::parse(client().Get("/api/state")->body);
  EXPECT_EQ(state["jobs"][0]["state"], "done");
  EXPECT_EQ(state["jobs"][0]["options"], Json::parse(R"({"wall":"3"})"));
  EXPECT_EQ(state["limits"]["bodyBytes"], 1'000'000);
  EXPECT_EQ(state["processes"].size(), 4u);
  const auto stl = client().Get("/api/jobs/j1/file/stl");
  EXPECT_EQ(stl->get_header_value("Content-Disposition"),
            "attachment; filename=\"block-hollow.stl\"; filename*=UTF-8''block-hollow.stl");
  EXPECT_EQ(stl->body.size(), state["jobs"][0]["files"][0]["bytes"]);
  EXPECT_EQ(Json::parse(client().Get("/api/jobs/j1/report")->body)["output"]["path"], "block-hollow.stl");
  EXPECT_TRUE(contains(client().Get("/api/jobs/j1/report.txt")->body, "block.stl"));
  EXPECT_GT(client().Get("/api/jobs/j1/scene")->body.size(), 1000u);
  EXPECT_EQ(client().Post("/api/jobs/j1/remove", "", "text/plain")->status, 200);
  EXPECT_EQ(client().Get("/api/jobs/j1/file/stl")->status, 404);
  EXPECT_EQ(client().Post("/api/models/m1/remove", "", "text/plain")->status, 200);
  EXPECT_EQ(folder_.entries(), 0u);
}

TEST_F(HttpServerTest, EveryAnswerSaysWhatAPageMay) {
  for (const std::string& request :
       {head("GET /api/state"), head("GET /"), head("GET /api/nothing"), head("PUT /"),
        std::string("nonsense\r\n\r\n"), fmt::format("GET /api/state HTTP/1.1\r\nHost: {}\r\n\r\n", host()),
        std::string("GET / HTTP/1.1\r\n\r\n"), head("POST /api/models", "Content-Length: 1000001\r\n"),
        head("GET /api/events")}) {
    const RawSocket socket(port());
    socket.send(request);
    const std::string answer = socket.receive("\r\n\r\n");
    for (const char* line :
         {"\r\nContent-Security-Policy: default-src 'none'; script-src 'self'; style-src 'self'; connect-src "
          "'self'; img-src 'self' blob: data:; base-uri 'none'; form-action 'none'; frame-ancestors "
          "'none'\r\n",
          "\r\nX-Content-Type-Options: nosniff\r\n", "\r\nReferrer-Policy: no-referrer\r\n",
          "\r\nCross-Origin-Resource-Policy: same-origin\r\n", "\r\nCache-Control: no-store\r\n"})
      EXPECT_TRUE(contains(answer, line)) << request;
    EXPECT_EQ(answer.find("Access-Control"), std::string::npos);
    EXPECT_EQ(answer.find("unsafe"), std::string::npos);
  }
}

TEST_F(HttpServerTest, WithoutTheTokenNothingIsSaidOrDone) {
  httplib::Client stranger("127.0.0.1", port());
  for (const char* path : {"/api/state", "/api/events", "/api/jobs/j1/file/stl", "/api/nothing"})
    EXPECT_EQ(stranger.Get(path)->status, 401) << path;
  EXPECT_EQ(stranger.Post("/api/models?name=block.stl", block(), "text/plain")->status, 401);
  // Not where it would be in logs.
  EXPECT_EQ(stranger.Get((std::string("/api/state?token=") + kToken).c_str())->status, 401);
  EXPECT_TRUE(folder_.studio().models().empty());
}

TEST_F(HttpServerTest, OtherHostsAndSitesAreRefused) {
  const std::string token = fmt::format("Authorization: Bearer {}\r\n", kToken);
  EXPECT_EQ(status("GET /api/state HTTP/1.1\r\nHost: evil.example\r\n" + token + "\r\n"), 421);
  EXPECT_EQ(status("GET / HTTP/1.1\r\nHost: evil.example\r\n\r\n"), 421);
  EXPECT_EQ(status("GET / HTTP/1.1\r\n\r\n"), 421);
  EXPECT_EQ(status(head("GET http://evil.example/api/state")), 404);  // not a path of ours
  EXPECT_EQ(status(head("POST /api/jobs/j1/stop", "Origin: http://evil.example\r\nContent-Length: 0\r\n")),
            403);
  EXPECT_EQ(status(head("GET /api/state", "Origin: null\r\n")), 403);
  EXPECT_EQ(status(head("GET /api/state", "Sec-Fetch-Site: cross-site\r\n")), 403);
  EXPECT_EQ(status(head("GET /api/state", fmt::format("Origin: http://{}\r\n", host()))), 200);
  EXPECT_EQ(status(head("GET /api/state", fmt::format("Host: {}\r\n", host()))), 400) << "twice";
}

TEST_F(HttpServerTest, ChangesAreMadeByPostAlone) {
  upload_block();
  for (const char* path : {"/api/models/m1/remove", "/api/jobs", "/api/models", "/api/jobs/j1/stop"})
    EXPECT_EQ(client().Get(path)->status, 404) << path;
  for (const char* method : {"DELETE", "PUT", "PATCH", "OPTIONS", "HEAD"})
    EXPECT_EQ(status(head(fmt::format("{} /api/models/m1/remove", method))), 405) << method;
  EXPECT_EQ(folder_.studio().models().size(), 1u);
}

TEST_F(HttpServerTest, ALongBodyIsRefusedBeforeAnyOfItIsRead) {
  // Nothing of it is sent, and the answer is there.
  const std::string answer = asked(head("POST /api/models?name=a.stl", "Content-Length: 1000001\r\n"));
  EXPECT_TRUE(contains(answer, "HTTP/1.1 413"));
  EXPECT_TRUE(contains(answer, "1 MB"));
  EXPECT_TRUE(contains(answer, "--max-upload"));
  const std::string expecting =
      asked(head("POST /api/models?name=a.stl", "Content-Length: 1000001\r\nExpect: 100-continue\r\n"));
  EXPECT_TRUE(expecting.starts_with("HTTP/1.1 413")) << expecting;
  EXPECT_EQ(status(head("POST /api/jobs", "Content-Length: 65537\r\n")), 413);
  EXPECT_EQ(folder_.entries(), 0u);
}

TEST_F(HttpServerTest, ABodyWithoutALengthIsCountedWhileItComes) {
  const RawSocket socket(port());
  socket.send(head("POST /api/models?name=a.stl", "Transfer-Encoding: chunked\r\n"));
  const std::string chunk = "10000\r\n" + std::string(0x10000, 'x') + "\r\n";
  for (int i = 0; i < 40 && socket.send(chunk); ++i) continue;  // without an end
  EXPECT_TRUE(contains(socket.receive(), "HTTP/1.1 413"));
  EXPECT_EQ(folder_.entries(), 0u);
  EXPECT_EQ(client().Get("/api/state")->status, 200);
}

TEST_F(HttpServerTest, PackedAndAmbiguousBodiesAreRefused) {
  EXPECT_EQ(status(head("POST /api/models?name=a.stl", "Content-Encoding: gzip\r\nContent-Length: 10\r\n")),
            415);
  EXPECT_EQ(status(head("POST /api/models?name=a.stl",
                        "Content-Type: multipart/form-data; boundary=x\r\nContent-Length: 10\r\n")),
            415);
  EXPECT_EQ(
      status(head("POST /api/models?name=a.stl", "Content-Length: 3\r\nTransfer-Encoding: chunked\r\n")),
      400);
  EXPECT_EQ(status(head("POST /api/models?name=a.stl", "Content-Length: 3\r\nContent-Length: 4\r\n")), 400);
}

TEST_F(HttpServerTest, WhatFollowsABodyIsNoRequest) {
  upload_block();
  const std::string inner = head("POST /api/models/m1/remove", "Content-Length: 0\r\n");
  for (const std::string& outer :
       {head("GET /api/state", fmt::format("Content-Length: {}\r\n", inner.size())), head("GET /api/state"),
        head("POST /api/models?name=x.exe", "Content-Length: 0\r\n")}) {
    const std::string answer = asked(outer + inner);
    EXPECT_EQ(answer.find("HTTP/1.1", 1), std::string::npos) << answer;
  }
  EXPECT_EQ(folder_.studio().models().size(), 1u);
}

TEST_F(HttpServerTest, AnUploadThatEndsEarlyLeavesNothing) {
  {
    const RawSocket socket(port());
    socket.send(head("POST /api/models?name=a.stl", "Content-Length: 1000\r\n") + "solid");
    for (int i = 0; i < 1000 && folder_.entries() == 0; ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    EXPECT_EQ(folder_.entries(), 1u);
  }
  for (int i = 0; i < 1000 && folder_.entries() > 0; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  EXPECT_EQ(folder_.entries(), 0u);
  EXPECT_TRUE(folder_.studio().models().empty());
}

TEST_F(HttpServerTest, NoPathOfARequestReachesTheFileSystem) {
  const auto model = client().Post("/api/models?name=..%2F..%2Fescaped.stl", block(), "text/plain");
  EXPECT_EQ(Json::parse(model->body)["name"], "escaped.stl");
  EXPECT_TRUE(std::filesystem::exists(folder_.path() / "m1" / "aerate-studio-model.stl"));
  EXPECT_FALSE(std::filesystem::exists(folder_.path().parent_path().parent_path() / "escaped.stl"));
  start(Json::object());
  folder_.wait_for("j1");
  for (const char* path :
       {"/../../etc/passwd", "/etc/passwd", "/%2e%2e/%2e%2e/etc/passwd", "/api/models/../../etc/passwd/scene",
        "/api/models/..%2F..%2Fm1/scene", "/api/jobs/j1/file/..%2Freport.json",
        "/api/jobs/j1/file/%2Fetc%2Fpasswd", "/api/jobs/j1/file/../report.json", "/api/jobs/../j1/report",
        "/api/jobs/j1/file/", "/api//state", "/studio.html", "/view.html", "//", "/api/jobs/j1/report/x"})
    EXPECT_EQ(status(head(fmt::format("GET {}", path))), 404) << path;
}

TEST_F(HttpServerTest, HeadsAreBounded) {
  const auto with_lines = [&](int count) {
    std::string lines;
    for (int i = 0; i < count; ++i) lines += fmt::format("X-More-{}: {}\r\n", i, std::string(1000, 'x'));
    return head("GET /api/state", lines);
  };
  EXPECT_EQ(status(with_lines(20)), 200);
  EXPECT_NE(status(with_lines(40)), 200);
  const RawSocket endless(port());  // one line
  for (int i = 0; i < 1000 && endless.send(std::string(10'000, 'x')); ++i) continue;
  EXPECT_EQ(endless.receive().find("200 OK"), std::string::npos);
  EXPECT_EQ(client().Get("/api/state")->status, 200);
}

TEST_F(HttpServerTest, WhoSaysNothingKeepsNobodyWaiting) {
  std::vector<std::unique_ptr<RawSocket>> silent;
  for (int i = 0; i < 12; ++i) silent.push_back(std::make_unique<RawSocket>(port()));
  EXPECT_EQ(client().Get("/api/state")->status, 200);
}

TEST_F(HttpServerTest, NonsenseIsToldFromARequest) {
  upload_block();
  for (const std::string& body :
       {std::string(), std::string("{"), std::string("[]"), std::string("null"),
        std::string(R"({"model":1})"), std::string(R"({"model":"m1","options":[]})"),
        std::string(R"({"model":"m1","options":{"wall":2}})"),
        std::string(R"({"model":"m1","options":{"wall":null}})"),
        std::string(R"({"model":"m1","options":{"holes-on":[]}})"),
        std::string(R"({"model":"m1","options":{"holes-on":[1]}})"), std::string(60'000, '['),
        std::string("\xff\xfe")})
    EXPECT_EQ(client().Post("/api/jobs", body, "application/json")->status, 400) << body.substr(0, 60);
  const auto unknown = client().Post("/api/jobs", R"({"model":"m9"})", "application/json");
  EXPECT_EQ(unknown->status, 404);
  const auto refused =
      client().Post("/api/jobs", R"({"model":"m1","options":{"wall":"-1"}})", "application/json");
  EXPECT_EQ(refused->status, 422);
  EXPECT_EQ(Json::parse(refused->body)["error"]["exit"], 2);
  const auto junk = client().Post("/api/models?name=junk.3mf", "junk", "text/plain");
  EXPECT_EQ(junk->status, 422);
  EXPECT_EQ(Json::parse(junk->body)["error"]["exit"], 3);
  EXPECT_EQ(client().Post("/api/models", "junk", "text/plain")->status, 422);  // without a name
}

TEST_F(HttpServerTest, FilesAreSentWhole) {
  upload_block();
  const std::string whole = client().Get("/api/models/m1/scene")->body;
  const auto part = client().Get("/api/models/m1/scene", {{"Range", "bytes=0-,0-,0-,5-6"}});
  EXPECT_EQ(part->status, 200);
  EXPECT_EQ(part->body, whole);
}

// Two tabs hear of a job that a third began; one of them is closed while it runs.
TEST_F(HttpServerTest, TabsHearOfEverything) {
  upload_block();
  const RawSocket first(port());
  {
    const RawSocket second(port());
    for (const RawSocket* tab : {&first, &second}) {
      tab->send(head("GET /api/events"));
      EXPECT_TRUE(contains(tab->receive("event: model"), "text/event-stream"));
    }
    EXPECT_EQ(status(head("GET /api/events")), 429) << "two may listen";
    start({{"wall", "3"}});
    EXPECT_TRUE(contains(second.receive("event: job"), R"("id":"j1")"));
  }
  EXPECT_TRUE(contains(first.receive(R"("state":"done")"), R"("state":"done")"));
  folder_.studio().remove_job("j1");
  EXPECT_TRUE(contains(first.receive("event: removed"), "event: removed"));
  // The place of the closed one is free again.
  const RawSocket third(port());
  third.send(head("GET /api/events", "Accept-Encoding: gzip, br\r\n"));
  EXPECT_TRUE(contains(third.receive("event: model"), R"("id":"m1")"));
}

TEST_F(HttpServerTest, EndsWithListenersAndUploadsUnderWay) {
  const RawSocket listener(port()), uploader(port());
  listener.send(head("GET /api/events"));
  uploader.send(head("POST /api/models?name=a.stl", "Content-Length: 1000\r\n"));
  listener.receive("\r\n\r\n");
  const auto begin = std::chrono::steady_clock::now();
  server_.reset();
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(5));
  EXPECT_EQ(folder_.entries(), 0u);
}

TEST_F(HttpServerTest, APortInUseIsNotShared) {
  const std::string message = test::message_of<UsageError>(
      [&] { const HttpServer second(folder_.studio(), "127.0.0.1", port(), kToken); });
  EXPECT_TRUE(contains(message, fmt::format("--port {}", port())));
  EXPECT_TRUE(contains(message, "leave out --port"));
  EXPECT_TRUE(contains(test::message_of<UsageError>(
                           [&] { const HttpServer second(folder_.studio(), "192.0.2.1", 0, kToken); }),
                       "--host 192.0.2.1"));
}

}  // namespace
}  // namespace aerate::studio
