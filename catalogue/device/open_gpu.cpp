#include "catalogue/device/device.hpp"
#include "core/errors.hpp"
#include "core/ranks/module.hpp"

namespace hmax {

bool has_gpu_module() { return HMAX_HAVE_CUDA; }

std::unique_ptr<Device> open_gpu() {
  if (!has_gpu_module())
    throw InputError(
        "this hmax was built without the module for GPUs; install nvcc of CUDA 12 or later from NVIDIA, "
        "then configure and build again, or leave out --device");
  return reinterpret_cast<MakeDevice>(symbol_of_module("hmax_cuda.so", make_device_symbol))();
}

}  // namespace hmax
