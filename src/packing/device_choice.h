#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/device.h"

namespace aerate {

// "auto", "cpu", "cuda" (the first device) or "cuda:N"; nullopt for anything else.
std::optional<DeviceRequest> parse_device(std::string_view text);

// What packing can run on, a line each, for `aerate --version`. Looks for devices, which starts the driver.
std::vector<std::string> describe_devices();

}  // namespace aerate
