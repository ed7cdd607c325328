#pragma once

#include <memory>
#include <string>

#include "studio/guard.h"
#include "studio/studio.h"

namespace aerate::studio {

// Puts a studio on a port of this machine. One request a connection, so that nothing that follows a body can be taken for a request;
// heads are bounded, bodies counted while they come.
class HttpServer {
 public:
  // Takes the port, or a free one for 0. Throws UsageError if it is taken or not to be had.
  HttpServer(Studio& studio, const std::string& host, int port, std::string token);
  ~HttpServer();  // ends all connections
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;

  const ServedAt& at() const;
  // "http://127.0.0.1:4321/#TOKEN": what follows the # is in no request and no log.
  std::string address() const;

 private:
  class Listener;
  std::unique_ptr<Listener> listener_;
};

}  // namespace aerate::studio
