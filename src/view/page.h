#pragma once

#include <string>
#include <string_view>

#include "view/scene.h"

namespace aerate {

// What a page shows: a header and the triangles, deflated (docs/view.md, "The format"). The same for any number of threads.
//   program: who made it, with its version
std::string page_bytes(const Scene& scene, std::string_view program);

// The same as it stands in a page, in base64.
std::string page_data(const Scene& scene, std::string_view program);

// Throws UsageError, with what was missing, if the program was built without the page.
void require_page();

// One file of HTML that needs nothing else. Throws as `require_page` does.
std::string page_of(const Scene& scene, std::string_view program);

}  // namespace aerate
