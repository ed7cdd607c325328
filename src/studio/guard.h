#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "studio/refusal.h"

// Who may ask. A page of any site that the user has open can send requests to this machine, and a name of its own that it lets
// point here (DNS rebinding): so it has to be known where a request comes from and whom it believes to ask, and it needs a token.

namespace aerate::studio {

// 192 bits from the kernel, as 48 hexadecimal digits. Throws FailureError.
std::string random_token();

// In a time that says nothing of where texts differ.
bool is_same_secret(std::string_view a, std::string_view b);

// Where the studio is to be found.
struct ServedAt {
  std::string host;  // the address that it was bound to: "127.0.0.1", "::1", "0.0.0.0"
  int port = 0;

  std::string origin() const;  // "http://127.0.0.1:4321", for who opens it on this machine
  // Whether a request may believe to ask this host and port.
  bool is_called(std::string_view host_and_port) const;
};

// What of a request says who asks for what. A header that is absent is nothing, and one that is there twice is refused before.
struct RequestHead {
  std::string method, path;
  std::optional<std::string> host = {}, origin = {}, fetch_site = {}, authorization = {}, content_type = {},
                             content_encoding = {}, content_length = {};
};

struct Guard {
  ServedAt at;
  std::string token;
  std::uint64_t most_body_bytes = 0;  // of a model's file

  // Why a request is not answered, by its head alone.
  std::optional<Refusal> refusal_of(const RequestHead& head) const;
};

// The page itself, which needs no token and holds nothing of the user's.
bool is_asset(std::string_view path);

// A model's file on its way in.
bool is_upload(std::string_view path);

// Bodies of all other requests.
inline constexpr std::uint64_t kMostRequestBytes = 64 << 10;

// What is said of a body that is larger than `most` bytes.
Refusal too_large(bool is_model, std::uint64_t most);

}  // namespace aerate::studio
