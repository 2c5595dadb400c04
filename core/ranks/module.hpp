/// Modules of hmax: libraries that are loaded when something of them is asked for.
#pragma once

#include <filesystem>

namespace hmax {

/// Where a module lies beside the program, in the build tree and where hmax is installed, whether it is there
/// or not.
/// @param file  "hmax_mpi.so"
std::filesystem::path module_file(const char* file);

/// The folder above that of the program: the build tree, or the prefix that hmax is installed in.
std::filesystem::path program_prefix();

/// Opens a module and finds what it offers.
/// It stays open.
/// @param file  "hmax_mpi.so"
/// @throws InputError  when the module cannot be opened or is of another hmax
void* symbol_of_module(const char* file, const char* symbol);

}  // namespace hmax
