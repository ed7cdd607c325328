#pragma once

// Marks functions that are compiled for the host by g++ and for host and device by nvcc.
#if defined(__CUDACC__)
#define AERATE_HD __host__ __device__
#else
#define AERATE_HD
#endif
