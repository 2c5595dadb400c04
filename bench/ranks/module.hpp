/// Modules of hmax: libraries that are loaded when something of them is asked for.
#pragma once

namespace hmax {

/// Opens a module that lies beside the program, in the build tree and where hmax is installed, and finds what it offers.
/// It stays open.
/// @param file  "hmax_mpi.so"
/// @throws InputError  when the module cannot be opened or is of another hmax
void* symbol_of_module(const char* file, const char* symbol);

}  // namespace hmax
