#pragma once

#include <cstddef>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

// What host code may know of CUDA without its headers, in builds with it and without (cuda_absent.cpp).

namespace aerate::kernels {

// A CUDA call that failed: `what()` says which, in or after which kernel, and what the runtime answered;
// `hint()` says what to try.
class CudaError : public std::runtime_error {
 public:
  enum class Kind {
    no_device,      // none, or none that this build can use
    out_of_memory,  // the device is as it was before; the job may be tried in smaller pieces
    failed,         // anything else; the device may be unusable for the rest of the process
  };

  CudaError(Kind kind, const std::string& what, std::string hint)
      : std::runtime_error(what), kind_(kind), hint_(std::move(hint)) {}

  Kind kind() const { return kind_; }
  const std::string& hint() const { return hint_; }

 private:
  Kind kind_;
  std::string hint_;
};

// What to try when a device's memory does not suffice.
inline constexpr const char* kTooLittleMemoryHint =
    "close other programs that use the device, or run on the CPU";

// What is said where CUDA was left out.
inline constexpr const char* kNoCuda = "this build has no CUDA";

// What the CUDA executor was built with ("CUDA 13.0, for 75-virtual"); empty if it was left out.
std::string cuda_build();

struct CudaDevice {
  std::string name;
  int major = 0, minor = 0;      // compute capability
  std::size_t memory_bytes = 0;  // of the device, used or not
};

struct CudaDevices {
  std::vector<CudaDevice> devices;  // by CUDA's index
  std::string problem;              // why there are none, in words; empty if there are some
};

// The devices of this machine. Starts the driver, which may take some tenths of a second; never throws.
CudaDevices find_cuda_devices();

}  // namespace aerate::kernels
