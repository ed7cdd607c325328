#include "studio/refusal.h"

#include <cerrno>
#include <new>
#include <system_error>

#include "core/error.h"

namespace aerate::studio {
namespace {

bool is_for_want_of_room(const std::string& what) {
  for (const int reason : {ENOSPC, EDQUOT, EFBIG})
    if (what.find(std::generic_category().message(reason)) != std::string::npos) return true;
  return false;
}

int status_of(const Error& error) {
  if (error.code() != ExitCode::failure) return 422;
  return is_for_want_of_room(error.what()) ? 507 : 500;
}

}  // namespace

Refusal refusal_of(const std::exception_ptr& thrown) {
  try {
    std::rethrow_exception(thrown);
  } catch (const Refused& refused) {
    return refused.refusal();
  } catch (const Error& error) {
    return {status_of(error), error.what(), error.hint(), static_cast<int>(error.code())};
  } catch (const std::bad_alloc&) {
    return {507, "out of memory",
            "give a larger --max-radius, --min-radius or --tolerance, or a smaller model",
            static_cast<int>(ExitCode::failure)};
  } catch (const std::exception& error) {
    return {500, error.what(), "this should not happen: please report it with the model and the options",
            static_cast<int>(ExitCode::failure)};
  }
}

}  // namespace aerate::studio
