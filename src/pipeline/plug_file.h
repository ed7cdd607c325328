#pragma once

#include <cstddef>
#include <filesystem>

#include "check/check_plugs.h"
#include "core/monitor.h"
#include "pipeline/announced_file.h"
#include "pipeline/carve_model.h"
#include "pipeline/options.h"
#include "printing/plugs.h"

namespace aerate {

// Plugs as they were written.
struct WrittenPlugs {
  PlugRequest request;
  Plugs plugs;
  PlugFacts facts;
  std::size_t bytes = 0;
};

// Throws UsageError for a file name that no mesh can be written to.
void require_writable(const PlugRequest& request);

// Writes plugs for the holes of a model that drains beside their target, reads them back and checks them; the file is
// not committed. Holes without room for one are told in a notice. Throws UsageError if there is room in none,
// and FailureError.
WrittenPlugs write_plugs(AnnouncedFile& pending, const HollowedModel& hollowed, const PlugRequest& request,
                         Monitor& monitor);

}  // namespace aerate
