#pragma once

#include <fmt/format.h>
#include <utility>

#include "core/error.h"

namespace aerate {

// Says that a result is not as it was meant to be: a fault of this program or of the disk, not of the model.
template <typename... Arguments>
[[noreturn]] void fail_check(fmt::format_string<Arguments...> why, Arguments&&... arguments) {
  throw FailureError("the result failed its check, so it was not kept: " +
                         fmt::format(why, std::forward<Arguments>(arguments)...),
                     "please report this with the model and the options");
}

}  // namespace aerate
