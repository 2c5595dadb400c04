#include "catalogue/models/series.hpp"

#include "core/input_error.hpp"
#include "core/numbers.hpp"

namespace hmax {

Table motion(const Problem& problem, const Method& method, double tolerance, double t_end, double every) {
  const auto* oscillator = std::get_if<Oscillator>(&problem.system);
  if (!oscillator)
    throw input_error("{} is not an oscillator, so it has no displacement to draw", problem.id);
  const RunSpec spec{.t_end = t_end, .adaptive = true, .rtol = tolerance, .atol = tolerance, .every = every};
  check(spec, method, problem);

  Table table{.columns = {"t [s]", "x [m]", "v [m/s]", "a [m/s^2]"}, .values = {{}, {}, {}, {}}};
  const RunRecord record = method.bind(problem).run(spec, [&](double t, const auto& y) {
    Eigen::Vector2d state = y, slope;
    oscillator->rhs(t, state, slope);
    const double row[] = {t, state[0], state[1], slope[1]};
    for (std::size_t column = 0; column < 4; ++column) table.values[column].push_back(row[column]);
  });
  table.notes = {{"problem", problem.id},
                 {"parameters", describe(problem.parameters)},
                 {"y0", describe(problem.shown.state(problem.y0))},
                 {"method", method.id},
                 {"rtol = atol", to_text(tolerance)},
                 {"outcome", std::string(to_string(record.outcome))}};
  if (!problem.material.empty()) table.notes.insert(table.notes.begin() + 1, {"material", problem.material});
  return table;
}

}  // namespace hmax
