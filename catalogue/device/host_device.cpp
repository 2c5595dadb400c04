#include "catalogue/device/host_device.hpp"

#include <chrono>
#include <cstring>
#include <limits>
#include <utility>

#include "catalogue/device/programs/device_program.hpp"

namespace hmax {

namespace {

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

struct HostBlock {
  bool backwards;
  template <class F>
  void each(std::int32_t count, const F& f) const {
    for (std::int32_t n = 0; n < count; ++n) f(backwards ? count - 1 - n : n);
  }
  void barrier() const {}
};

}  // namespace

double HostDevice::seconds() { return std::exchange(seconds_, 0); }

DeviceFacts HostDevice::facts() const {
  return {
      .name = "the processor", .driver = "none", .shared_memory = std::numeric_limits<std::size_t>::max()};
}

void* HostDevice::allocate(std::size_t bytes) {
  std::vector<double> memory(bytes / sizeof(double) + 1);
  // What nobody has written is no number, of either precision.
  void* const place = std::memset(memory.data(), 0xff, bytes);
  memory_.emplace(place, std::move(memory));
  return place;
}

void HostDevice::release(void* memory) { memory_.erase(memory); }

void HostDevice::write(void* to, const void* from, std::size_t bytes) { std::memcpy(to, from, bytes); }
void HostDevice::read(void* to, const void* from, std::size_t bytes) { std::memcpy(to, from, bytes); }
void HostDevice::copy(void* to, const void* from, std::size_t bytes) { std::memcpy(to, from, bytes); }

void HostDevice::run(std::span<const DeviceProgram> programs, std::int64_t times, LoadEvaluations loads) {
  const double begun = now();
  const HostBlock block{backwards_};
  std::vector<double> shared;
  for (std::int64_t n = 0; n < times; ++n) {
    for (const DeviceProgram& program : programs)
      program.visit([&](const auto& own) {
        const std::size_t bytes = shared_bytes_of(own);
        shared.resize(bytes / sizeof(double) + 1);
        with_kind(own, [&](auto kind) {
          block.each(static_cast<std::int32_t>(blocks_of(own)), [&](std::int32_t number) {
            std::memset(shared.data(), 0xff, bytes);  // no numbers
            run_block(kind, block, own, number, shared.data());
          });
        });
      });
    if (loads.before) *loads.before += loads.each;
  }
  seconds_ += now() - begun;
}

}  // namespace hmax
