/// What formulas are made of, and its values where they are the same on every processor and device.
#pragma once

#include <cmath>
#include <cstdint>

#include "core/instructions/device_code.hpp"

namespace hmax {

/// What a node computes of its operands a, b and c: in the order of their number.
enum class FormulaOp : std::uint8_t {
  constant,
  time,
  state,

  negate,
  square,
  cube,
  fourth,
  sin,
  cos,
  tan,
  asin,
  acos,
  atan,
  sinh,
  cosh,
  tanh,
  asinh,
  acosh,
  atanh,
  exp,
  log,
  log2,
  log10,
  sqrt,
  abs,
  sign,
  rint,

  less,
  less_equal,
  greater,
  greater_equal,
  equal,
  not_equal,
  minimum,
  maximum,
  both,
  either,
  add,
  subtract,
  multiply,
  divide,
  power,
  atan2,

  choose
};

/// How many operands an operation has.
constexpr int operands_of(FormulaOp op) {
  return op <= FormulaOp::state ? 0 : op <= FormulaOp::rint ? 1 : op < FormulaOp::choose ? 2 : 3;
}

/// The value of an operation that is exact or rounded once, which is the same everywhere; other(op, a, b) of
/// the others. A condition is true where it is not 0; comparisons give 1 or 0.
template <class Other>
HMAX_DEVICE inline double arithmetic_value(FormulaOp op, double a, double b, double c, const Other& other) {
  switch (op) {
    case FormulaOp::negate:
      return -a;
    case FormulaOp::add:
      return a + b;
    case FormulaOp::subtract:
      return a - b;
    case FormulaOp::multiply:
      return a * b;
    case FormulaOp::divide:
      return a / b;
    case FormulaOp::square:
      return a * a;
    case FormulaOp::cube:
      return a * a * a;
    case FormulaOp::fourth:
      return (a * a) * (a * a);
    case FormulaOp::less:
      return a < b ? 1 : 0;
    case FormulaOp::less_equal:
      return a <= b ? 1 : 0;
    case FormulaOp::greater:
      return a > b ? 1 : 0;
    case FormulaOp::greater_equal:
      return a >= b ? 1 : 0;
    case FormulaOp::equal:
      return a == b ? 1 : 0;
    case FormulaOp::not_equal:
      return a != b ? 1 : 0;
    case FormulaOp::both:
      return a != 0 && b != 0 ? 1 : 0;
    case FormulaOp::either:
      return a != 0 || b != 0 ? 1 : 0;
    case FormulaOp::choose:
      return a != 0 ? b : c;
    case FormulaOp::minimum:
      return b < a ? b : a;
    case FormulaOp::maximum:
      return a < b ? b : a;
    case FormulaOp::sqrt:
      return std::sqrt(a);
    case FormulaOp::abs:
      return std::abs(a);
    case FormulaOp::sign:
      return a < 0 ? -1 : a > 0 ? 1 : 0;
    case FormulaOp::rint:
      return a - std::floor(a) < 0.5 ? std::floor(a) : std::ceil(a);
    default:
      return other(op, a, b);
  }
}

}  // namespace hmax
