#include "studio/guard.h"

#include <algorithm>
#include <arpa/inet.h>
#include <cctype>
#include <charconv>
#include <fmt/format.h>
#include <sys/random.h>

#include "core/error.h"

namespace aerate::studio {
namespace {

bool is_every_address(std::string_view host) {
  return host == "0.0.0.0" || host == "::";
}

std::string in_url(const std::string& host) {
  return host.find(':') == std::string::npos ? host : "[" + host + "]";
}

std::string lowered(std::string_view text) {
  std::string lower(text);
  std::ranges::transform(lower, lower.begin(),
                         [](unsigned char byte) { return static_cast<char>(std::tolower(byte)); });
  return lower;
}

bool is_address(const std::string& host) {
  in6_addr address{};
  return ::inet_pton(AF_INET, host.c_str(), &address) == 1 ||
         ::inet_pton(AF_INET6, host.c_str(), &address) == 1;
}

// "[::1]" -> "::1"
std::string without_brackets(std::string host) {
  if (host.size() > 2 && host.front() == '[' && host.back() == ']') host = host.substr(1, host.size() - 2);
  return host;
}

std::optional<std::uint64_t> parse_length(std::string_view text) {
  std::uint64_t length = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), length);
  if (text.empty() || error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return length;
}

std::optional<Refusal> refusal_of_body(const RequestHead& head, std::uint64_t most_of_model) {
  if (head.content_encoding && lowered(*head.content_encoding) != "identity")
    return Refusal{415, "compressed bodies are not taken", "send the file as it is"};
  if (head.content_type && lowered(*head.content_type).starts_with("multipart/"))
    return Refusal{415, "bodies of several parts are not taken", "send the file itself as the body"};
  if (!head.content_length) return std::nullopt;
  const auto length = parse_length(*head.content_length);
  if (!length) return Refusal{400, "the length of the body is no number", ""};
  const std::uint64_t most = is_upload(head.path) ? most_of_model : kMostRequestBytes;
  if (*length <= most) return std::nullopt;
  return too_large(is_upload(head.path), most);
}

}  // namespace

Refusal too_large(bool is_model, std::uint64_t most) {
  if (!is_model) return {413, fmt::format("the request is larger than {} bytes", most), ""};
  return {413, fmt::format("the file is larger than {:.4g} MB", static_cast<double>(most) / 1e6),
          "start 'aerate studio' with a larger --max-upload"};
}

std::string random_token() {
  unsigned char bytes[24];
  if (::getrandom(bytes, sizeof bytes, 0) != static_cast<ssize_t>(sizeof bytes))
    throw FailureError("the system gives no random numbers", "");
  std::string token;
  for (const unsigned char byte : bytes) token += fmt::format("{:02x}", byte);
  return token;
}

bool is_same_secret(std::string_view a, std::string_view b) {
  volatile unsigned char difference = a.size() == b.size() ? 0 : 1;
  for (std::size_t i = 0; i < a.size(); ++i)
    difference = static_cast<unsigned char>(
        difference |
        (static_cast<unsigned char>(a[i]) ^ static_cast<unsigned char>(b.empty() ? 0 : b[i % b.size()])));
  return difference == 0;
}

std::string ServedAt::origin() const {
  const std::string here = host == "0.0.0.0" ? "127.0.0.1" : host == "::" ? "::1" : host;
  return fmt::format("http://{}:{}", in_url(here), port);
}

bool ServedAt::is_called(std::string_view host_and_port) const {
  const std::size_t colon = host_and_port.rfind(':');
  const bool has_port = colon != std::string_view::npos && host_and_port.back() != ']';
  const std::string_view named_port = has_port ? host_and_port.substr(colon + 1) : "80";
  if (named_port != std::to_string(port)) return false;
  const std::string name =
      without_brackets(lowered(host_and_port.substr(0, has_port ? colon : host_and_port.size())));
  if (name == host || name == "localhost") return true;
  // An address cannot be made to point elsewhere.
  return is_every_address(host) && is_address(name);
}

bool is_asset(std::string_view path) {
  return path == "/" || path == "/studio.js" || path == "/studio.css";
}

bool is_upload(std::string_view path) {
  return path == "/api/models";
}

std::optional<Refusal> Guard::refusal_of(const RequestHead& head) const {
  if (head.method != "GET" && head.method != "POST")
    return Refusal{405, "only GET and POST are answered", ""};
  if (!head.host || !at.is_called(*head.host))
    return Refusal{421, "this is not the host that the request is for",
                   fmt::format("open {} as 'aerate studio' printed it", at.origin())};
  if (head.origin && lowered(*head.origin) != "http://" + lowered(*head.host))
    return Refusal{403, "requests of other sites are not answered", ""};
  if (is_asset(head.path)) {
    if (head.method == "GET") return std::nullopt;
    return Refusal{405, "this is only to be read", ""};
  }
  if (head.fetch_site && *head.fetch_site != "same-origin" && *head.fetch_site != "none")
    return Refusal{403, "requests of other sites are not answered", ""};
  constexpr std::string_view kBearer = "Bearer ";
  if (!head.authorization || !head.authorization->starts_with(kBearer) ||
      !is_same_secret(std::string_view(*head.authorization).substr(kBearer.size()), token))
    return Refusal{401, "the token is missing or wrong",
                   "open the address that 'aerate studio' printed, with all that follows the #"};
  return refusal_of_body(head, most_body_bytes);
}

}  // namespace aerate::studio
