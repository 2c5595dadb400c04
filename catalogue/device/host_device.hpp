/// The programs of devices on the processor: what their results have to be, and how they are tested where
/// there is no device.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "catalogue/device/device.hpp"

namespace hmax {

/// Threads of a block one after the other. In either order the results are the same, unless a program reads
/// before a barrier what another thread writes there.
class HostDevice final : public Device {
 public:
  /// @param backwards  the last thread and the last block come first
  explicit HostDevice(bool backwards = false) : backwards_(backwards) {}

  [[nodiscard]] DeviceFacts facts() const override;
  [[nodiscard]] void* allocate(std::size_t bytes) override;
  void release(void* memory) override;
  void write(void* to, const void* from, std::size_t bytes) override;
  void read(void* to, const void* from, std::size_t bytes) override;
  void copy(void* to, const void* from, std::size_t bytes) override;
  void run(std::span<const DeviceProgram> programs, std::int64_t times, LoadEvaluations loads) override;
  [[nodiscard]] double seconds() override;

 private:
  bool backwards_;
  double seconds_ = 0;
  std::map<void*, std::vector<double>> memory_;
};

}  // namespace hmax
