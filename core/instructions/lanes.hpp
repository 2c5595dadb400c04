/// Numbers side by side as one number: every operation is done to all of them at once.
#pragma once

#include <cmath>
#include <cstddef>

#include <Eigen/Core>

namespace hmax {

/// Four numbers. Each has the bits that it would have alone, with every instruction set. It is a scalar of
/// Eigen's matrices, for functions that compiled_for.hpp compiles. In memory it is an array: vectors would be
/// passed to functions in another way by each instruction set.
class Lanes {
 public:
  static constexpr std::size_t count = 4;

  Lanes() = default;
  /// The same number in all.
  [[gnu::always_inline]] Lanes(double same) { put(Vector{same, same, same, same}); }
  /// value(lane) in each.
  template <class Value>
  requires std::is_invocable_r_v<double, const Value&, std::size_t>
  [[gnu::always_inline]] explicit Lanes(const Value& value) {
    put(Vector{value(std::size_t{0}), value(std::size_t{1}), value(std::size_t{2}), value(std::size_t{3})});
  }

  [[nodiscard, gnu::always_inline]] double operator[](std::size_t lane) const { return get()[lane]; }
  /// (0 + 1) + (2 + 3)
  [[nodiscard, gnu::always_inline]] double sum() const {
    const Vector& all = get();
    return (all[0] + all[1]) + (all[2] + all[3]);
  }

  [[gnu::always_inline]] Lanes& operator+=(const Lanes& b) { return put(get() + b.get()); }
  [[gnu::always_inline]] Lanes& operator-=(const Lanes& b) { return put(get() - b.get()); }
  [[gnu::always_inline]] Lanes& operator*=(const Lanes& b) { return put(get() * b.get()); }
  [[gnu::always_inline]] Lanes& operator/=(const Lanes& b) { return put(get() / b.get()); }
  [[gnu::always_inline]] friend Lanes operator+(const Lanes& a, const Lanes& b) { return Lanes(a) += b; }
  [[gnu::always_inline]] friend Lanes operator-(const Lanes& a, const Lanes& b) { return Lanes(a) -= b; }
  [[gnu::always_inline]] friend Lanes operator*(const Lanes& a, const Lanes& b) { return Lanes(a) *= b; }
  [[gnu::always_inline]] friend Lanes operator/(const Lanes& a, const Lanes& b) { return Lanes(a) /= b; }
  [[gnu::always_inline]] friend Lanes operator-(const Lanes& a) { return Lanes().put(-a.get()); }
  [[gnu::always_inline]] friend Lanes sqrt(const Lanes& a) {
    return Lanes([&](std::size_t lane) __attribute__((always_inline)) { return std::sqrt(a[lane]); });
  }

 private:
  using Vector [[gnu::may_alias]] = double __attribute__((vector_size(32)));
  [[nodiscard, gnu::always_inline]] const Vector& get() const {
    return *reinterpret_cast<const Vector*>(all_);
  }
  [[gnu::always_inline]] Lanes& put(const Vector& all) {
    *reinterpret_cast<Vector*>(all_) = all;
    return *this;
  }
  alignas(32) double all_[count];
};

}  // namespace hmax

/// Eigen asks for less than the alignment that Lanes have by themselves, which clang refuses.
template <int Size>
requires(Size != Eigen::Dynamic) struct Eigen::internal::compute_default_alignment<hmax::Lanes, Size> {
  enum { value = 0 };
};

template <>
struct Eigen::NumTraits<hmax::Lanes> : Eigen::NumTraits<double> {
  using Real = hmax::Lanes;
  using NonInteger = hmax::Lanes;
  using Nested = hmax::Lanes;
  using Literal = hmax::Lanes;
};
