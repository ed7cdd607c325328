#pragma once

#include <string>

#include "core/mesh.h"
#include "core/monitor.h"
#include "pipeline/support.h"

namespace aerate::cli {

enum class Fill { plain, spheres, cells };

// Voids in a body of supports, by `hollow` with the thinnest walls that the process prints. Of the ways that it can be done the
// first that takes much is taken, else the one that leaves least. Throws what `hollow` throws for the last of them if it can be done in none.
//   process: its name or its file
//   given: an overhang angle and a bridge that go before the process's
FoamedBody foamed(const Mesh& body, Fill fill, const std::string& process, const Limits& given,
                  const MayOpen& may_open, Monitor& monitor);

}  // namespace aerate::cli
