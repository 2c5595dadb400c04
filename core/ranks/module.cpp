#include "core/ranks/module.hpp"

#include <dlfcn.h>
#include <string>

#include "core/input_error.hpp"

namespace hmax {

std::filesystem::path program_prefix() {
  std::error_code unknown;
  return std::filesystem::read_symlink("/proc/self/exe", unknown).parent_path().parent_path();
}

std::filesystem::path module_file(const char* file) { return program_prefix() / HMAX_MODULES / file; }

void* symbol_of_module(const char* file, const char* symbol) {
  const std::string path = module_file(file).string();
  // Global, because the parts that OpenMPI loads look for its symbols there. It stays open: MPI ends once.
  void* const module = dlopen(path.c_str(), RTLD_NOW | RTLD_GLOBAL);
  if (!module)
    throw input_error("the module {} cannot be opened: {}; build or install hmax again", file, dlerror());
  void* const found = dlsym(module, symbol);
  if (!found) throw input_error("{} is no module of this hmax; build or install hmax again", path);
  return found;
}

}  // namespace hmax
