#include "catalogue/device/host_device.hpp"

#include <cstring>
#include <limits>

namespace hmax {

namespace {

struct HostBlock {
  bool backwards;
  template <class F>
  void each(std::int32_t count, const F& f) const {
    for (std::int32_t n = 0; n < count; ++n) f(backwards ? count - 1 - n : n);
  }
  void barrier() const {}
};

}  // namespace

DeviceFacts HostDevice::facts() const {
  return {
      .name = "the processor", .driver = "none", .shared_memory = std::numeric_limits<std::size_t>::max()};
}

void* HostDevice::allocate(std::size_t bytes) {
  // What nobody has written is no number.
  memory_.emplace_back(bytes / sizeof(double) + 1, std::numeric_limits<double>::quiet_NaN());
  return memory_.back().data();
}

void HostDevice::write(void* to, const void* from, std::size_t bytes) { std::memcpy(to, from, bytes); }
void HostDevice::read(void* to, const void* from, std::size_t bytes) { std::memcpy(to, from, bytes); }
void HostDevice::copy(void* to, const void* from, std::size_t bytes) { std::memcpy(to, from, bytes); }

void HostDevice::run(std::span<const BodyStep> steps, std::size_t shared, std::int64_t times) {
  std::vector<double> memory;
  for (std::int64_t n = 0; n < times; ++n)
    for (const BodyStep& step : steps)
      HostBlock{backwards_}.each(step.body.patches, [&](std::int32_t patch) {
        memory.assign(shared, std::numeric_limits<double>::quiet_NaN());
        const HostBlock block{backwards_};
        if (step.body.law == TetLaw::green) body_step<TetLaw::green>(block, step, patch, memory.data());
        if (step.body.law == TetLaw::small_strain)
          body_step<TetLaw::small_strain>(block, step, patch, memory.data());
        if (step.body.law == TetLaw::neo_hookean)
          body_step<TetLaw::neo_hookean>(block, step, patch, memory.data());
      });
}

void HostDevice::begin(const BodyStep& step) {
  for (std::int32_t i = 0; i < 3; ++i)
    HostBlock{backwards_}.each(step.body.free, [&](std::int32_t p) { first_kick_drift(step, i, p); });
}

}  // namespace hmax
