/// Oscillators of different parameters side by side, in the lanes of vector registers.
#pragma once

#include <array>
#include <cstddef>

#include "problems/oscillator/oscillator.hpp"

namespace hmax {

/// N oscillators; what Oscillator computes of each, with the same bits. Numbers of all lanes stand side by
/// side, so that a loop over lanes becomes vector operations.
template <std::size_t N>
class OscillatorLanes {
 public:
  using State = Oscillator::State;

  void set(std::size_t lane, const Oscillator& system) {
    const OscillatorParameters& p = system.parameters();
    c_m_[lane] = p.c / p.m;
    k1_m_[lane] = p.k1 / p.m;
    k3_m_[lane] = p.k3 / p.m;
    P_m_[lane] = p.P / p.m;
    w_[lane] = p.w;
  }

  /// w t, whose cosine force() takes.
  [[gnu::always_inline]] double angle(std::size_t lane, double t) const { return w_[lane] * t; }

  /// Oscillator::at() of a lane.
  /// @param cosine  of the angle
  [[gnu::always_inline]] double force(std::size_t lane, double cosine) const {
    const double force = P_m_[lane] * cosine;
    return P_m_[lane] != 0 ? force : 0.0;  // no -0 where no force is
  }

  /// Oscillator::rhs_at() of a lane: x' = v, v' = (force - x (k1 + k3 x^2) / m) - c v / m.
  [[gnu::always_inline]] void rhs_at(std::size_t lane, double force, const State& y, State& dydt) const {
    const double x = y[0];
    const double v = y[1];
    dydt[0] = v;
    dydt[1] = (force - x * (k1_m_[lane] + k3_m_[lane] * (x * x))) - c_m_[lane] * v;
  }

 private:
  alignas(64) std::array<double, N> c_m_{}, k1_m_{}, k3_m_{}, P_m_{}, w_{};
};

}  // namespace hmax
