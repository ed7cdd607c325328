#pragma once

#include <filesystem>

#include "printing/processes.h"

namespace aerate {

// Reads a process of the user's own, a JSON object (docs/processes.md):
//   {"name": "my-resin", "base": "sla", "title": "..", "material": "resin", "drainage": true,
//    "wall": 1.5, "gap": {"value": 0.8, "source": "the maker's data sheet"}}
// Keys are the names of limit_rows(); what is not given comes from the base (fdm if there is none).
// Throws InputError for a file that cannot be read or is not JSON, UsageError for unknown keys, wrong types,
// figures out of range, or an unknown base.
Process read_process_file(const std::filesystem::path& path);

}  // namespace aerate
