#pragma once

// AERATE_HD marks functions that are compiled for the host by g++ and for host and device by nvcc.
// AERATE_UNROLL, before a loop with a constant number of turns over a small array: nvcc must unroll it to
// keep the array in registers (scripts/check-ptxas sees to it that it did). AERATE_NO_UNROLL: it must not,
// since several turns at once take more registers than there are.
#if defined(__CUDACC__)
#define AERATE_HD __host__ __device__
#else
#define AERATE_HD
#endif
#if defined(__CUDA_ARCH__)
#define AERATE_UNROLL _Pragma("unroll")
#define AERATE_NO_UNROLL _Pragma("unroll 1")
#else
#define AERATE_UNROLL
#define AERATE_NO_UNROLL
#endif
