#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "studio/records.h"
#include "studio/refusal.h"
#include "studio/studio.h"

// What each request does (docs/studio.md, "The API"), without any HTTP.

namespace aerate::studio {

struct ApiRequest {
  std::string method, path;
  std::string name;  // the parameter
};

// Calls what it is given with the body, piece by piece, for as long as that returns true; false if the body could not be read to its
// end.
using BodyReader = std::function<bool(const std::function<bool(std::string_view)>&)>;

struct Answer {
  int status = 200;
  std::string type = "application/json";
  std::string body = {};
  std::optional<KeptFile> file = {};  // in the place of the body
  bool is_to_save = false;            // the file is one to save under its name
  bool is_event_stream = false;       // events follow, for as long as somebody listens
};

Answer answer_to(const Refusal& refusal);

// Never throws: a refusal is an answer.
Answer answer(Studio& studio, const ApiRequest& request, const BodyReader& body);

// The events of what is new, as a stream of events has them.
std::string events_of(const Changes& changes);

}  // namespace aerate::studio
