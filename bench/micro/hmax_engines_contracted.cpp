// hmax's side once more, for the program in which it may contract to fused multiply-add like Odeint's.
#include "bench/micro/hmax_engines.cpp"  // NOLINT(bugprone-suspicious-include): compiled with other flags
