#include <gtest/gtest.h>
#include <set>
#include <string>

#include "studio/guard.h"

namespace aerate::studio {
namespace {

TEST(Token, IsLongAndNeverTheSame) {
  std::set<std::string> tokens;
  for (int i = 0; i < 100; ++i) tokens.insert(random_token());
  EXPECT_EQ(tokens.size(), 100u);
  for (const std::string& token : tokens) {
    EXPECT_GE(token.size(), 32u);  // 128 bits in hexadecimal
    EXPECT_EQ(token.find_first_not_of("0123456789abcdef"), std::string::npos);
  }
}

TEST(Token, IsComparedToItsEnd) {
  EXPECT_TRUE(is_same_secret("abcd", "abcd"));
  for (const char* other : {"", "a", "abc", "abcde", "abcdabcd", "bbcd", "abce"}) {
    EXPECT_FALSE(is_same_secret(other, "abcd")) << other;
    EXPECT_FALSE(is_same_secret("abcd", other)) << other;
  }
  EXPECT_FALSE(is_same_secret("a", ""));
}

TEST(ServedAt, IsCalledByItsAddressAndPort) {
  const ServedAt here{"127.0.0.1", 4321};
  for (const char* name : {"127.0.0.1:4321", "localhost:4321", "LocalHost:4321"})
    EXPECT_TRUE(here.is_called(name)) << name;
  for (const char* name :
       {"", "127.0.0.1", "127.0.0.1:4322", "localhost", "evil.example:4321", "evil.example",
        "127.0.0.1.evil.example:4321", "127.0.0.2:4321", "localhost.:4321", "[::1]:4321",
        "127.0.0.1:4321:4321", ":4321", "127.0.0.1:04321", "user@127.0.0.1:4321"})
    EXPECT_FALSE(here.is_called(name)) << name;
  EXPECT_EQ(here.origin(), "http://127.0.0.1:4321");
}

TEST(ServedAt, OfEveryAddressIsCalledByAddressesAndNoOtherNames) {
  const ServedAt everywhere{"0.0.0.0", 80};
  EXPECT_TRUE(everywhere.is_called("192.168.1.2:80"));
  EXPECT_TRUE(everywhere.is_called("192.168.1.2"));  // the port of http
  EXPECT_TRUE(everywhere.is_called("[fe80::1]:80"));
  EXPECT_FALSE(everywhere.is_called("evil.example:80"));
  EXPECT_EQ(everywhere.origin(), "http://127.0.0.1:80");
  EXPECT_EQ((ServedAt{"::1", 4321}.origin()), "http://[::1]:4321");
  EXPECT_TRUE((ServedAt{"::1", 4321}.is_called("[::1]:4321")));
}

class GuardTest : public testing::Test {
 protected:
  const Guard guard_{{"127.0.0.1", 4321}, "secret", 1000};

  RequestHead asking(const std::string& method, const std::string& path) const {
    RequestHead head{.method = method, .path = path};
    head.host = "127.0.0.1:4321";
    head.authorization = "Bearer secret";
    return head;
  }
  int status(const RequestHead& head) const {
    const auto refusal = guard_.refusal_of(head);
    return refusal ? refusal->status : 200;
  }
};

TEST_F(GuardTest, AnswersWhoHasTheToken) {
  EXPECT_EQ(status(asking("GET", "/api/state")), 200);
  EXPECT_EQ(status(asking("POST", "/api/models")), 200);
}

TEST_F(GuardTest, RefusesWhoHasNot) {
  for (const char* path : {"/api/state", "/api/events", "/api/models/m1/scene", "/api/jobs/j1/report", "/api",
                           "/api/", "/nothing", "/studio.html"}) {
    RequestHead head = asking("GET", path);
    for (const char* wrong :
         {"", "Bearer ", "Bearer secre", "Bearer secret2", "Basic secret", "secret", "bearer secret"}) {
      head.authorization = wrong;
      EXPECT_EQ(status(head), 401) << path << " " << wrong;
    }
    head.authorization.reset();
    EXPECT_EQ(status(head), 401) << path;
  }
}

TEST_F(GuardTest, ThePageItselfNeedsNoToken) {
  for (const char* path : {"/", "/studio.js", "/studio.css"}) {
    RequestHead head = asking("GET", path);
    head.authorization.reset();
    EXPECT_EQ(status(head), 200) << path;
    head.method = "POST";
    EXPECT_EQ(status(head), 405) << path;
  }
}

TEST_F(GuardTest, OnlyGetAndPostAreMethods) {
  for (const char* method : {"HEAD", "PUT", "DELETE", "OPTIONS", "PATCH", "TRACE", "CONNECT"})
    for (const char* path : {"/", "/api/state"}) EXPECT_EQ(status(asking(method, path)), 405) << method;
}

// A name of somebody's that points to this machine.
TEST_F(GuardTest, AnotherHostIsRefusedEvenForThePage) {
  for (const char* path : {"/", "/api/state"}) {
    RequestHead head = asking("GET", path);
    head.host = "evil.example:4321";
    EXPECT_EQ(status(head), 421) << path;
    head.host.reset();
    EXPECT_EQ(status(head), 421) << path;
  }
}

TEST_F(GuardTest, RequestsOfOtherSitesAreRefused) {
  RequestHead head = asking("POST", "/api/models");
  for (const char* origin : {"http://evil.example", "null", "", "https://127.0.0.1:4321", "http://127.0.0.1",
                             "http://127.0.0.1:4322", "http://localhost:4321"}) {
    head.origin = origin;
    EXPECT_EQ(status(head), 403) << origin;
  }
  head.origin = "http://127.0.0.1:4321";
  EXPECT_EQ(status(head), 200);
  for (const char* site : {"cross-site", "same-site"}) {
    head.fetch_site = site;
    EXPECT_EQ(status(head), 403) << site;
  }
  head.fetch_site = "same-origin";
  EXPECT_EQ(status(head), 200);
  // A link that leads to the page itself.
  RequestHead link = asking("GET", "/");
  link.fetch_site = "cross-site";
  EXPECT_EQ(status(link), 200);
}

TEST_F(GuardTest, BodiesAreRefusedByTheirLength) {
  RequestHead head = asking("POST", "/api/models");
  head.content_length = "1000";
  EXPECT_EQ(status(head), 200);
  for (const char* more : {"1001", "18446744073709551615"}) {
    head.content_length = more;
    EXPECT_EQ(status(head), 413) << more;
  }
  EXPECT_NE(guard_.refusal_of(head)->hint.find("--max-upload"), std::string::npos);
  for (const char* none : {"", "-1", "1e3", "10 ", "99999999999999999999999"}) {
    head.content_length = none;
    EXPECT_EQ(status(head), 400) << none;
  }
  RequestHead job = asking("POST", "/api/jobs");
  job.content_length = std::to_string(kMostRequestBytes + 1);
  EXPECT_EQ(status(job), 413);
}

// What would be unpacked, or taken apart, before it is counted.
TEST_F(GuardTest, PackedBodiesAreRefused) {
  RequestHead head = asking("POST", "/api/models");
  head.content_encoding = "gzip";
  EXPECT_EQ(status(head), 415);
  head.content_encoding = "identity";
  EXPECT_EQ(status(head), 200);
  head.content_type = "Multipart/Form-Data; boundary=x";
  EXPECT_EQ(status(head), 415);
}

}  // namespace
}  // namespace aerate::studio
