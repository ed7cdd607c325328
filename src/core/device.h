#pragma once

#include <string>

namespace aerate {

// Where a packing is to be computed. The result is the same everywhere.
struct DeviceRequest {
  enum class Kind {
    automatic,       // a CUDA device if the job is large enough to be worth it and fits, else the CPU
    cpu,             // all threads
    cpu_one_thread,  // the serial reference
    cuda,            // that device or an error
  };
  Kind kind = Kind::automatic;
  int index = 0;  // of the CUDA device
};

// Where it was computed, and why there; for the report.
struct DeviceUse {
  std::string name = "cpu";  // or "cuda:0 (name of the device)"
  std::string reason;        // "asked for", or what decided
};

}  // namespace aerate
