#include <dlfcn.h>

#include <filesystem>

#include <fmt/format.h>

#include "bench/distributed/distributed_engine.hpp"
#include "results/errors.hpp"

namespace hmax {
namespace {

/// The module lies beside the program: it is found from there, in the build tree and where hmax is installed.
std::filesystem::path module_file() {
  std::error_code unknown;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", unknown);
  return program.parent_path().parent_path() / HMAX_PETSC_MODULE;
}

}  // namespace

bool has_distributed_engine() { return HMAX_HAVE_PETSC; }

std::unique_ptr<DistributedEngine> open_distributed_engine() {
  if (!has_distributed_engine())
    throw InputError(
        "this hmax was built without the engine petsc; install the Debian packages petsc-dev and slepc-dev, then configure "
        "and build again, or leave out --engine");
  const std::string file = module_file().string();
  // Global, because the parts that OpenMPI loads look for its symbols there. It stays open: MPI ends once.
  void* const module = dlopen(file.c_str(), RTLD_NOW | RTLD_GLOBAL);
  if (!module) throw InputError(fmt::format("the engine petsc cannot be opened: {}; build or install hmax again", dlerror()));
  void* const symbol = dlsym(module, make_engine_symbol);
  if (!symbol) throw InputError(fmt::format("{} is no engine of this hmax; build or install hmax again", file));
  return reinterpret_cast<MakeDistributedEngine>(symbol)();
}

}  // namespace hmax
