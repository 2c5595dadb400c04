/// A device that runs block programs beside the processor, such as a GPU: a module opens it.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace hmax {

struct DeviceProgram;

/// What times on a device depend on.
struct DeviceFacts {
  std::string name;               ///< "NVIDIA H100 80GB HBM3"
  double clock_mhz = 0;           ///< the highest of its processors
  std::string driver;             ///< with the version of the run time behind it
  double flops = 0;               ///< double precision, operations a second; a fused one counts as one
  double single_flops = 0;        ///< the same of single precision
  double bytes = 0;               ///< of its memory, a second
  std::size_t shared_memory = 0;  ///< that a block may have [B]
};

/// How often programs evaluate loads.
struct LoadEvaluations {
  /// BodyStep::evaluated, in the memory of the device; it grows. Null: never.
  std::int64_t* before = nullptr;
  std::int32_t each = 0;  ///< those of all programs, once
  bool operator==(const LoadEvaluations&) const = default;
};

/// Memory of a device and the programs that it runs, one after the other.
/// @throws InputError  for errors of the device: too little memory, a lost card
class Device {
 public:
  Device() = default;
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;
  virtual ~Device() = default;

  [[nodiscard]] virtual DeviceFacts facts() const = 0;
  /// Freed with the device.
  [[nodiscard]] virtual void* allocate(std::size_t bytes) = 0;
  virtual void release(void* memory) = 0;
  virtual void write(void* to, const void* from, std::size_t bytes) = 0;
  virtual void read(void* to, const void* from, std::size_t bytes) = 0;
  virtual void copy(void* to, const void* from, std::size_t bytes) = 0;

  /// Programs one after the other, over and over again.
  virtual void run(std::span<const DeviceProgram> programs, std::int64_t times, LoadEvaluations loads) = 0;
  /// What programs have taken since the last call [s], by events of the device.
  [[nodiscard]] virtual double seconds() = 0;
};

/// Memory of a device that is released with its owner, also where there is too little for all that the owner
/// needs.
class DeviceMemory {
 public:
  /// @param device  outlives this
  explicit DeviceMemory(Device& device) : device_(device) {}
  DeviceMemory(const DeviceMemory&) = delete;
  DeviceMemory& operator=(const DeviceMemory&) = delete;
  ~DeviceMemory() {
    for (void* const place : places_) device_.release(place);
  }

  [[nodiscard]] Device& device() const { return device_; }
  /// Room for so many of T.
  template <class T>
  [[nodiscard]] T* room(std::size_t count) {
    return static_cast<T*>(
        places_.emplace_back(device_.allocate(std::max<std::size_t>(1, count) * sizeof(T))));
  }
  /// A copy of these.
  template <class T>
  [[nodiscard]] const T* copy(const std::vector<T>& values) {
    T* const to = room<T>(values.size());
    if (!values.empty()) device_.write(to, values.data(), values.size() * sizeof(T));
    return to;
  }

 private:
  Device& device_;
  std::vector<void*> places_;
};

/// Whether this build has the module.
bool has_gpu_module();

/// Opens the module and the first card.
/// @throws InputError  in one sentence, where the module or the card is missing
std::unique_ptr<Device> open_gpu();

/// What the module offers.
/// @throws InputError  where there is no card
using MakeDevice = std::unique_ptr<Device> (*)();
inline constexpr const char* make_device_symbol = "hmax_make_device";

}  // namespace hmax
