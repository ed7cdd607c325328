#pragma once

#include <filesystem>
#include <gtest/gtest.h>
#include <string>
#include <vector>

#include "printing/slicers/slicers.h"
#include "tests/support/files.h"
#include "tests/support/process.h"

namespace aerate::test {

// A model as PrusaSlicer slices it under these options. Fails the test if it does not.
inline GcodeFigures slice_with_prusa(const std::filesystem::path& model, const std::filesystem::path& gcode,
                                     const std::vector<std::string>& options) {
  std::vector<std::string> command{"prusa-slicer", "--export-gcode"};
  command.insert(command.end(), options.begin(), options.end());
  command.insert(command.end(), {"--output", gcode, model});
  const ProcessResult result = run(command);
  if (result.exit_code != 0 || !std::filesystem::exists(gcode)) {
    ADD_FAILURE() << "the slicer failed on " << model << ": " << result.out << result.err;
    return {};
  }
  return figures_of(read_bytes(gcode), prusa_slicer());
}

}  // namespace aerate::test
