/// Functions that compilers of devices take too.
#pragma once

/// Before a function that a device may call: nothing but arithmetic and what is marked so itself.
#ifdef __CUDACC__
#define HMAX_DEVICE __host__ __device__
#else
#define HMAX_DEVICE
#endif
