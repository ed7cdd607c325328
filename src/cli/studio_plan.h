#pragma once

#include "studio/lent.h"

namespace aerate::cli {

// What the studio has from the command line: the options of 'aerate hollow' but for those that name files or say how a program runs,
// and how it understands them.
studio::Lent lent_to_studio();

}  // namespace aerate::cli
