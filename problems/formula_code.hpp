/// The operations of formulas one after the other: one source for the processor and for threads of devices.
#pragma once

#include <cstdint>

#include "core/instructions/device_code.hpp"
#include "problems/formula_operations.hpp"

namespace hmax {

/// Registers hold t, y, the constants, and the values of the nodes, in this order.
/// Most are operations, registers[to] = op(a, b, c). The other codes follow the last of FormulaOp.
struct FormulaStep {
  static constexpr std::uint8_t jump_unless = 253,  ///< goes on at step `c` where a is 0
      jump = 254,                                   ///< goes on at step `c`
      copy = 255;                                   ///< registers[to] = registers[a]
  std::uint8_t code;
  std::uint32_t to, a, b, c;
};

/// Where they lie.
struct FormulaCode {
  const FormulaStep* steps;      ///< shape (step_count)
  const double* constants;       ///< shape (constant_count)
  const std::uint32_t* results;  ///< registers of the values, shape (result_count)
  std::uint32_t step_count, constant_count, result_count, states;
};

/// The values of formulas at (t, y).
/// @param registers  room for those of the code, shape (FormulaProgram::registers())
/// @param y          shape (states)
/// @param values     shape (result_count)
/// @param other      as of arithmetic_value()
template <class Other>
HMAX_DEVICE inline void run_formulas(const FormulaCode& code, double* registers, double t, const double* y,
                                     double* values, const Other& other) {
  registers[0] = t;
  double* next = registers + 1;
  for (std::uint32_t i = 0; i < code.states; ++i) *next++ = y[i];
  for (std::uint32_t i = 0; i < code.constant_count; ++i) *next++ = code.constants[i];
  const FormulaStep* const end = code.steps + code.step_count;
  for (const FormulaStep* step = code.steps; step != end; ++step) {
    const double a = registers[step->a], b = registers[step->b];
    double& result = registers[step->to];
    switch (step->code) {
      case FormulaStep::copy:
        result = a;
        break;
      case FormulaStep::jump_unless:
        if (a == 0) step = code.steps + step->c - 1;
        break;
      case FormulaStep::jump:
        step = code.steps + step->c - 1;
        break;
      default:
        result = arithmetic_value(static_cast<FormulaOp>(step->code), a, b, registers[step->c], other);
    }
  }
  for (std::uint32_t i = 0; i < code.result_count; ++i) values[i] = registers[code.results[i]];
}

}  // namespace hmax
