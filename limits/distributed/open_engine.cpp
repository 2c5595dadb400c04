#include "core/errors.hpp"
#include "core/ranks/module.hpp"
#include "limits/distributed/distributed_engine.hpp"

namespace hmax {

bool has_distributed_engine() { return HMAX_HAVE_PETSC; }

std::unique_ptr<DistributedEngine> open_distributed_engine() {
  if (!has_distributed_engine())
    throw InputError(
        "this hmax was built without the engine petsc; install the Debian packages petsc-dev and slepc-dev, then configure "
        "and build again, or leave out --engine");
  return reinterpret_cast<MakeDistributedEngine>(symbol_of_module("hmax_petsc.so", make_engine_symbol))();
}

}  // namespace hmax
