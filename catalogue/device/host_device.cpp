#include "catalogue/device/host_device.hpp"

#include <chrono>
#include <cstring>
#include <limits>
#include <utility>

#include "catalogue/device/motion_program.hpp"

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

template <class Real>
void run_all(bool backwards, std::span<const BodyStep<Real>> steps, std::size_t shared, std::int64_t times,
             std::int64_t* evaluated) {
  const HostBlock block{backwards};
  std::vector<Real> memory;
  for (std::int64_t n = 0; n < times; ++n) {
    for (const BodyStep<Real>& step : steps)
      block.each(step.body.patches, [&](std::int32_t patch) {
        memory.assign(shared, std::numeric_limits<Real>::quiet_NaN());
        if (step.body.law == TetLaw::green) body_step<TetLaw::green>(block, step, patch, memory.data());
        if (step.body.law == TetLaw::small_strain)
          body_step<TetLaw::small_strain>(block, step, patch, memory.data());
        if (step.body.law == TetLaw::neo_hookean)
          body_step<TetLaw::neo_hookean>(block, step, patch, memory.data());
      });
    *evaluated += static_cast<std::int64_t>(steps.size());
  }
}

template <class Real>
void begin_all(bool backwards, const BodyStep<Real>& step) {
  for (std::int32_t i = 0; i < 3; ++i)
    HostBlock{backwards}.each(step.body.free, [&](std::int32_t p) { first_kick_drift(step, i, p); });
}

template <class Motions>
void run_fixed(const HostBlock& block, const Motions& motions) {
  with_explicit_method(motions.method, [&]<class Method>(const Method&) {
    block.each(static_cast<std::int32_t>(motions.count),
               [&](std::int32_t n) { advance_motion<Method>(motions, n); });
  });
}

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

void HostDevice::run(std::span<const BodyStep<double>> steps, std::size_t shared, std::int64_t times,
                     std::int64_t* evaluated) {
  const double begun = now();
  run_all(backwards_, steps, shared, times, evaluated);
  seconds_ += now() - begun;
}
void HostDevice::run(std::span<const BodyStep<float>> steps, std::size_t shared, std::int64_t times,
                     std::int64_t* evaluated) {
  run_all(backwards_, steps, shared, times, evaluated);
}
void HostDevice::begin(const BodyStep<double>& step) { begin_all(backwards_, step); }
void HostDevice::begin(const BodyStep<float>& step) { begin_all(backwards_, step); }

void HostDevice::run(const AdaptiveMotions& motions) {
  HostBlock{backwards_}.each(static_cast<std::int32_t>(motions.count), [&](std::int32_t n) {
    motions.steady ? advance_motion<true>(motions, n) : advance_motion<false>(motions, n);
  });
}

void HostDevice::run(const SharedMotions& motions) { run_fixed(HostBlock{backwards_}, motions); }
void HostDevice::run(const OwnMotions& motions) { run_fixed(HostBlock{backwards_}, motions); }

}  // namespace hmax
