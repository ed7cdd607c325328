#pragma once

#include <exception>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

namespace aerate::studio {

// What is answered instead of what was asked for: in the words of the command line where it would say the same.
struct Refusal {
  int status = 500;  // of HTTP
  std::string what, hint;
  std::optional<int> exit =
      {};  // the documented exit status of the program; absent where a program has no such case
};

class Refused : public std::runtime_error {
 public:
  explicit Refused(Refusal refusal) : std::runtime_error(refusal.what), refusal_(std::move(refusal)) {}
  const Refusal& refusal() const { return refusal_; }

 private:
  Refusal refusal_;
};

// Of whatever was thrown: a Refused's own, an Error's words with its exit status (507 if the disk is full), or that the program is
// at fault.
Refusal refusal_of(const std::exception_ptr& thrown);

}  // namespace aerate::studio
