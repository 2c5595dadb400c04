/// hmax order: the order of convergence that a method shows on a problem.
#include "analysis/amplification/order.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>

#include <fmt/format.h>

#include "bench/timing/reference.hpp"
#include "cli/shared/choices.hpp"
#include "cli/shared/commands.hpp"
#include "cli/shared/options.hpp"
#include "core/errors.hpp"
#include "core/numbers.hpp"
#include "core/size_limits.hpp"
#include "limits/linearised_problem.hpp"
#include "results/json.hpp"

namespace hmax {

namespace {

using Extended = Eigen::Vector<long double, Eigen::Dynamic>;

/// End times to look at [s]: within the first ten seconds, or within a shorter problem.
std::vector<double> end_times(double problem_end) {
  const double last = std::min(10.0, problem_end);
  return {0.1 * last, 0.2 * last, 0.3 * last, 0.4 * last, 0.6 * last, 0.8 * last, last};
}

struct OrderOptions {
  ProblemChoice problem;
  MethodChoice method;
  std::optional<double> t_end;
};

/// A method of variable order has no order to expect, and no runs at fixed step that could show one.
void report_variable_order(const Problem& problem, const Method& method, Console& console) {
  const std::string status = fmt::format(
      "{} chooses order and step as it runs, so there is no order to measure; `hmax precision` shows its "
      "error against its cost",
      method.id);
  if (console.json)
    return console.print_json(Json{{"problem", problem.id},
                                   {"method", method.id},
                                   {"expected", Json()},
                                   {"observed", Json()},
                                   {"h", Json::array()},
                                   {"error", Json::array()},
                                   {"status", status}});
  console.print(status + "\n");
}

/// What was measured, and how.
struct OrderReport {
  OrderObservation seen;
  int expected = 0;
  double tolerance = 0;
  double fastest =
      0;  ///< the largest |eigenvalue| of the Jacobian at the start [1/s]; 0 where it is not known
  bool extended = false;  ///< in long double
  bool blurred = false;   ///< by the error of the reference, before it is by rounding
  std::string reference;

  [[nodiscard]] bool shown() const {
    return seen.observed && std::abs(*seen.observed - expected) <= tolerance;
  }

  /// Whether the steps are long beside the fastest time scale, and the slopes below the order of the method.
  [[nodiscard]] bool is_reduced() const {
    if (seen.h.size() < 2 || shown() || !(seen.h.back() * fastest > 1)) return false;
    return seen.observed ? *seen.observed < expected
                         : seen.lack == OrderLack::not_asymptotic && slope(seen.h.size() - 1) < expected;
  }

  /// What errors below the floor are worth.
  [[nodiscard]] std::string_view floor() const {
    return blurred ? "the error of the reference" : "rounding level";
  }

  /// Whether the slopes come visibly nearer to the expected order up to the step at which errors are
  /// rounding.
  [[nodiscard]] bool is_unsettled() const {
    if (shown() || !seen.observed || !seen.h_rounded) return false;
    double before = std::numeric_limits<double>::infinity();
    for (std::size_t i = 1; i < seen.h.size(); ++i) {
      const double off = slope(i) - expected;
      if (std::abs(off) >= std::abs(before) || (i > 1 && off * before < 0)) return false;
      before = off;
    }
    return std::abs(slope(1) - slope(seen.h.size() - 1)) > 0.01;
  }

  /// From one point to the next.
  [[nodiscard]] double slope(std::size_t i) const {
    return std::log(seen.error[i - 1] / seen.error[i]) / std::log(seen.h[i - 1] / seen.h[i]);
  }

  /// Why there is no order, or another one; empty where the expected one is shown.
  [[nodiscard]] std::string status() const {
    if (shown()) return "";
    if (is_reduced())
      return fmt::format(
          "order reduction: the problem is stiff here, h |lambda| is {} at the finest step; order {} shows at steps far "
          "below {} s",
          short_number(seen.h.back() * fastest, 2), expected, short_number(1 / fastest, 2));
    const auto at = [](const std::optional<double>& h) { return short_number(h.value_or(0), 3); };
    if (is_unsettled())
      return fmt::format(
          "the slopes still change, from {:.3f} to {:.3f}, where errors reach {} at h = {} s: the "
          "steps above it are too large to show order {}; try another --t-end",
          slope(1), slope(seen.h.size() - 1), floor(), at(seen.h_rounded), expected);
    switch (seen.lack) {
      case OrderLack::diverged:
        return fmt::format(
            "the runs diverge, or miss the solution, at all steps down to h = {} s; try a smaller --t-end",
            at(seen.h_diverged));
      case OrderLack::rounded:
        return fmt::format("errors are at {} from h = {} s on{}; try another --t-end", floor(),
                           at(seen.h_rounded), seen.h.empty() ? "" : ", and above it are too few steps");
      case OrderLack::narrow:
        return fmt::format(
            "the runs diverge, or miss the solution, down to h = {} s, and errors are at {} from h = {} s on; "
            "try another --t-end",
            at(seen.h_diverged), floor(), at(seen.h_rounded));
      case OrderLack::stalled:
        return fmt::format(
            "the error no longer falls from h = {} s on, far above rounding: the runs do not converge to "
            "the reference",
            at(seen.h_rounded));
      case OrderLack::not_asymptotic:
        return "the slopes differ by more than 0.5: the steps are not in the asymptotic range yet; try another --t-end";
      case OrderLack::none:
        break;
    }
    return fmt::format("the slope is not within {} of the order {}; try another --t-end", tolerance,
                       expected);
  }

  /// The status in a word.
  [[nodiscard]] std::string_view reason() const {
    return is_reduced()     ? "order_reduction"
           : is_unsettled() ? "unsettled"
           : seen.observed  ? ""
                            : name_of(seen.lack);
  }
};

/// The largest |eigenvalue| of the Jacobian at the start [1/s]; 0 where it is not known.
double fastest_rate(const Problem& problem) {
  double fastest = 0;
  if (problem.y0.size() > most_explained_states) return fastest;
  try {
    for (const std::complex<double> lambda : linearised(problem, 0, problem.y0).modes.spectrum.lambda)
      fastest = std::max(fastest, std::abs(lambda));
  } catch (const InputError&) {
    // Without a spectrum nothing is said of stiffness.
  }
  return fastest;
}

/// The largest number of the solution at the start and at the end times.
template <class Exact>
double size_of(const Problem& problem, const std::vector<double>& times, const Exact& exact) {
  double size = problem.y0.cwiseAbs().maxCoeff();
  for (const double t : times) size = std::max(size, static_cast<double>(exact(t).cwiseAbs().maxCoeff()));
  return size;
}

/// Errors over the step at a few end times [s], and the slope that they show.
OrderReport measured(const Method& method, const Problem& problem, const std::vector<double>& times,
                     Console& console) {
  const Reference reference = make_reference(problem, times.back());
  if (reference.valid_until < times.back())
    throw InputError(
        fmt::format("the solution of {} cannot be followed beyond t = {} s; give a smaller --t-end",
                    problem.id, to_text(reference.valid_until)));

  // A foreign engine may have double alone.
  const Runner runner = method.bind(problem);
  const bool extended = reference.extended_at && runner.end_state_extended;
  const auto exact = [&](double t) -> Extended {
    return reference.extended_at ? reference.extended_at(t) : reference.at(t).cast<long double>();
  };
  const auto end_state = [&](double h, double t_end) -> Extended {
    if (runner.end_state_extended) return runner.end_state_extended(h, t_end);
    return runner.run({.t_end = t_end, .h = h}, {}).y.cast<long double>();
  };
  const long double epsilon =
      extended ? std::numeric_limits<long double>::epsilon() : std::numeric_limits<double>::epsilon();
  const double size = size_of(problem, times, exact);
  // Rounding of up to 20000 steps, with a margin that keeps it out of the slope.
  const auto rounding = static_cast<double>(200 * epsilon * size);
  const double blur = 30 * (reference.extended_at ? reference.extended_error : reference.error_bound);

  Progress progress(console, "order");
  const auto error_of = [&](double t_end, double h) {
    const auto at = static_cast<double>(std::ranges::find(times, t_end) - times.begin());
    progress.update(at / static_cast<double>(times.size()));
    return static_cast<double>((end_state(h, t_end) - exact(t_end)).cwiseAbs().maxCoeff());
  };
  return {.seen = observe_order(error_of, times, {std::max(rounding, blur), size}),
          .expected = order_on(method, problem),
          .tolerance = method.order_tolerance(),
          .fastest = fastest_rate(problem),
          .extended = extended,
          .blurred = blur > rounding,
          .reference = reference.name};
}

Json to_json(const OrderReport& report, const Method& method, const Problem& problem) {
  const OrderObservation& seen = report.seen;
  return {{"problem", problem.id},
          {"method", method.id},
          {"expected", report.expected},
          {"observed", json_or_null(seen.observed)},
          HMAX_KEYS(seen, h, error),
          {"tolerance", report.tolerance},
          {"status", report.status()},
          {"reason", json_or_null(report.reason())},
          {"t_end", seen.t_end},
          {"parameters", describe(problem.parameters)},
          {"y0", describe(problem.shown.state(problem.y0))},
          {"precision", report.extended ? "long double" : "double"},
          {"reference", report.reference}};
}

std::string in_words(const OrderReport& report, const Method& method, const Problem& problem,
                     const Console& console) {
  const OrderObservation& seen = report.seen;
  std::string text;
  if (!seen.h.empty())
    text += fmt::format("{} on {}, error at t = {} s in {}\n\n", method.id, problem.id, to_text(seen.t_end),
                        report.extended ? "long double" : "double");
  TextTable table({"h [s]", "error", "slope"});
  for (std::size_t i = 0; i < seen.h.size(); ++i)
    table.add({short_number(seen.h[i]), short_number(seen.error[i], 4),
               i == 0 ? "" : fmt::format("{:.3f}", report.slope(i))});
  if (!seen.h.empty()) text += table.text(console) + "\n";
  const std::string verdict =
      seen.observed
          ? fmt::format("observed order {:.3f}, expected {}{}", *seen.observed, report.expected,
                        report.expected == method.order ? "" : " where forces do not depend on velocities")
          : "no order";
  return text + (report.shown() ? console.strong(verdict) + "\n"
                                : console.alarming(verdict) + ": " + report.status() + "\n");
}

void order(const OrderOptions& options, Console& console) {
  const Problem problem = options.problem.make();
  const Method method = options.method.make();
  options.problem.remark_idle(console, problem);
  if (method.has_variable_order()) return report_variable_order(problem, method, console);
  const std::vector<double> times = options.t_end ? std::vector{*options.t_end} : end_times(problem.t_end);
  check({.t_end = times.back(), .h = times.back()}, method, problem);
  const OrderReport report = measured(method, problem, times, console);
  if (!report.shown()) console.exit_code = Exit::failed;
  console.show(to_json(report, method, problem), in_words(report, method, problem, console));
}

}  // namespace

void add_order(CLI::App& app, Console& console) {
  const auto [command, options] =
      add_command(app, console, "order",
                  "Measure the order of convergence of a method; exit 1 when it is not the expected one",
                  {"hmax order --problem liver_forced --method rk4",
                   "hmax order --problem liver_cubic --method dop_853 --json"},
                  order);
  options.problem.add_to(command);
  options.method.add_to(command);
  add_number(
      command, "--t-end", options.t_end,
      "Time at which the error is measured [s]; that of seven within the first 10 s with the steadiest slope by default");
}

}  // namespace hmax
