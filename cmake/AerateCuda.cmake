# CUDA, where nvcc works: defines AERATE_WITH_CUDA (ON or OFF) and the cache options
#   AERATE_CUDA                AUTO uses CUDA if it can and says why if not, ON insists, OFF leaves it out
#   AERATE_CUDA_ARCHITECTURES  auto: the devices of this machine; without any, PTX that the driver of whatever
#                              machine it gets to compiles (one architecture: a quick build)
#                              release: real code for every architecture below, PTX of the newest
#                              or a list as CMake's CUDA_ARCHITECTURES takes it
set(AERATE_CUDA AUTO CACHE STRING "Build the CUDA executor: AUTO, ON or OFF")
set_property(CACHE AERATE_CUDA PROPERTY STRINGS AUTO ON OFF)
set(AERATE_CUDA_ARCHITECTURES auto CACHE STRING
  "Architectures to compile for: auto, release, or a list as CUDA_ARCHITECTURES")
set(AERATE_CUDA_RELEASE_ARCHITECTURES
  75-real 80-real 86-real 89-real 90-real 100-real 120-real 120-virtual)
set(AERATE_CUDA_OLDEST_NVCC 12.8)  # C++20, sm_120, and the CCCL 2.7 that the scan needs

# Leaves CUDA out, or fails when it was asked for.
macro(_aerate_without_cuda reason)
  if(AERATE_CUDA STREQUAL "AUTO")
    message(STATUS "CUDA: left out (${reason})")
  else()
    message(FATAL_ERROR "AERATE_CUDA=ON, but ${reason}. Give the compiler as -DCMAKE_CUDA_COMPILER=/path/to/nvcc, "
      "or configure with -DAERATE_CUDA=OFF.")
  endif()
endmacro()

set(AERATE_WITH_CUDA OFF)
if(NOT AERATE_CUDA STREQUAL "OFF" AND NOT AERATE_CUDA)
  message(FATAL_ERROR "AERATE_CUDA is '${AERATE_CUDA}': AUTO, ON or OFF")
endif()
if(NOT AERATE_CUDA STREQUAL "OFF")
  # nvcc is often installed without being on the path.
  if(NOT CMAKE_CUDA_COMPILER AND NOT DEFINED ENV{CUDACXX})
    find_program(AERATE_NVCC nvcc HINTS ENV CUDA_HOME ENV CUDA_PATH PATHS /usr/local/cuda /opt/cuda PATH_SUFFIXES bin)
    mark_as_advanced(AERATE_NVCC)
  endif()
  if(NOT CMAKE_CUDA_COMPILER AND NOT DEFINED ENV{CUDACXX} AND NOT AERATE_NVCC)
    _aerate_without_cuda("nvcc was not found")
  else()
    if(AERATE_NVCC AND NOT DEFINED ENV{CUDACXX})
      set(ENV{CUDACXX} "${AERATE_NVCC}")
    endif()
    if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND NOT CMAKE_CUDA_HOST_COMPILER)
      set(CMAKE_CUDA_HOST_COMPILER "${CMAKE_CXX_COMPILER}")
    endif()
    # Tries nvcc in a project of its own, so that one that is there but does not work is no error for AUTO.
    include(CheckLanguage)
    check_language(CUDA)
    if(NOT CMAKE_CUDA_COMPILER)
      unset(CMAKE_CUDA_COMPILER CACHE)  # looked for again by the next run
      _aerate_without_cuda("nvcc cannot compile a program: see CMakeFiles/CMakeError.log")
    else()
      if(NOT CMAKE_CUDA_ARCHITECTURES)
        set(CMAKE_CUDA_ARCHITECTURES 75-virtual)  # for the compiler's own check; set below
      endif()
      enable_language(CUDA)
      if(CMAKE_CUDA_COMPILER_VERSION VERSION_LESS AERATE_CUDA_OLDEST_NVCC)
        _aerate_without_cuda("nvcc is ${CMAKE_CUDA_COMPILER_VERSION} and ${AERATE_CUDA_OLDEST_NVCC} or newer is needed")
      else()
        set(AERATE_WITH_CUDA ON)
      endif()
    endif()
  endif()
endif()

if(AERATE_WITH_CUDA)
  if(AERATE_CUDA_ARCHITECTURES STREQUAL "release")
    set(CMAKE_CUDA_ARCHITECTURES ${AERATE_CUDA_RELEASE_ARCHITECTURES})
  elseif(NOT AERATE_CUDA_ARCHITECTURES STREQUAL "auto")
    set(CMAKE_CUDA_ARCHITECTURES ${AERATE_CUDA_ARCHITECTURES})
  elseif(CMAKE_CUDA_ARCHITECTURES_NATIVE)
    set(CMAKE_CUDA_ARCHITECTURES ${CMAKE_CUDA_ARCHITECTURES_NATIVE})
  else()
    set(CMAKE_CUDA_ARCHITECTURES 75-virtual)
  endif()
  message(STATUS "CUDA: nvcc ${CMAKE_CUDA_COMPILER_VERSION} for ${CMAKE_CUDA_ARCHITECTURES}")
  if(AERATE_CCACHE AND NOT CMAKE_CUDA_COMPILER_LAUNCHER)
    # By the contents of files, not by preprocessed text: nvcc preprocesses twice, for the host and for devices,
    # and ccache would look at one of them only.
    set(CMAKE_CUDA_COMPILER_LAUNCHER "${CMAKE_COMMAND}" -E env CCACHE_DEPEND=1 CCACHE_NAMESPACE=nvcc "${AERATE_CCACHE}")
  endif()

  # The standard is given as an option because CMake 3.25 does not know that nvcc has C++20. As for C++, a*b+c
  # is never contracted. Kernels may call constexpr functions of the standard library (numeric_limits). -Wpedantic and -Wconversion are for the compiler that sees the sources themselves:
  # through nvcc they complain about the code that it generates.
  target_compile_options(aerate_options INTERFACE
    $<$<COMPILE_LANG_AND_ID:CUDA,NVIDIA>:-std=c++20 --fmad=false --expt-relaxed-constexpr
      -Xcompiler=-ffp-contract=off,-Wall,-Wextra,-Wnon-virtual-dtor,-Woverloaded-virtual>)
endif()
