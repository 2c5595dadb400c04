#include "analysis/dynamics/kink.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

namespace hmax {
namespace {

using Eigen::Vector2d;

constexpr int in_quadrant = 2048, directions = 4 * in_quadrant;  ///< of a turn
constexpr double ds = 2 * 27.6 / in_quadrant;

/// Directions around 0 lie closer towards the axes, beside which stiff fields turn: in each quadrant s = ln
/// tan(phi) grows evenly from -27.6 to 27.6, so that dphi = ds / (2 cosh s). Sums over s converge like those
/// of periodic functions where f bends at the axes alone.
struct Direction {
  Vector2d u;
  double width;  ///< [rad]
};

Direction direction(int k) {
  const int quadrant = k / in_quadrant % 4, i = k % in_quadrant;
  const double s = ds * (i + 0.5 - 0.5 * in_quadrant);
  const Vector2d u = Vector2d(1, std::exp(s)).normalized();
  const std::array<Vector2d, 4> turned{u, Vector2d(-u(1), u(0)), Vector2d(-u), Vector2d(u(1), -u(0))};
  return {turned[static_cast<std::size_t>(quadrant)], ds / (2 * std::cosh(s))};
}

/// Of a field r g(u) in the direction u = (cos phi, sin phi): r' = radial r, phi' = angular [1/s].
struct Rates {
  double radial, angular, size;  ///< size: |g|

  [[nodiscard]] bool is_on_ray(double rounding) const { return std::abs(angular) <= rounding * size; }
};

/// The direction between two others, the second one ahead, where the angular rate changes its sign. Where it
/// jumps motions slide along it, at the mean of both sides that does not turn [filippov1988differential], or
/// part and none follows it.
template <class Field>
std::optional<Kink::Ray> crossed_ray(const Field& field, Vector2d from, Vector2d to) {
  const bool sign = field(from).angular > 0;
  for (int i = 0; i < 60; ++i) {
    const Vector2d middle = (from + to).normalized();
    ((field(middle).angular > 0) == sign ? from : to) = middle;
  }
  const Rates a = field(from), b = field(to);
  if (a.is_on_ray(1e-9)) return Kink::Ray{from, a.radial};
  if (b.is_on_ray(1e-9)) return Kink::Ray{to, b.radial};
  if (!sign) return std::nullopt;
  return Kink::Ray{from, (a.radial * -b.angular + b.radial * a.angular) / (a.angular - b.angular)};
}

/// The direction between two others where the angular rate touches zero, as at critical damping.
template <class Field>
std::optional<Kink::Ray> touched_ray(const Field& field, const Vector2d& from, const Vector2d& to) {
  const auto at = [&](double t) -> Vector2d { return ((1 - t) * from + t * to).normalized(); };
  double least = 0, most = 1;
  for (int i = 0; i < 60; ++i) {
    const double third = (most - least) / 3;
    const bool is_left =
        std::abs(field(at(least + third)).angular) < std::abs(field(at(most - third)).angular);
    (is_left ? most : least) += is_left ? -third : third;
  }
  const Vector2d found = at((least + most) / 2);
  const Rates rates = field(found);
  return rates.is_on_ray(1e-9) ? std::optional(Kink::Ray{found, rates.radial}) : std::nullopt;
}

/// The ray in the middle one of three directions, or from there to the last one.
template <class Field>
std::optional<Kink::Ray> ray_at(const Field& field, const std::array<Vector2d, 3>& u,
                                const std::array<Rates, 3>& rates) {
  const auto& [before, here, after] = rates;
  if (here.is_on_ray(1e-12)) return Kink::Ray{u[1], here.radial};
  if ((here.angular > 0) != (after.angular > 0) && !after.is_on_ray(1e-12))
    return crossed_ray(field, u[1], u[2]);
  const double speed = std::abs(here.angular);
  const bool is_crossed_before = (before.angular > 0) != (here.angular > 0);
  if (!is_crossed_before && speed < std::abs(before.angular) && speed <= std::abs(after.angular))
    return touched_ray(field, u[0], u[2]);
  return std::nullopt;
}

}  // namespace

// A turn takes T = int dphi / |angular| and grows by exp(int radial dphi / |angular|).
Kink kink_around(const std::function<Vector2d(const Vector2d&)>& f, const Vector2d& y, const Vector2d& r,
                 double unit) {
  Vector2d scale(r(0), r(0) * unit);
  scale *= std::min(1.0, r(1) / scale(1));
  const auto field = [&](const Vector2d& u) -> Rates {
    const Vector2d g = f(y + scale.cwiseProduct(u)).cwiseQuotient(scale);
    return {u.dot(g), u(0) * g(1) - u(1) * g(0), g.norm()};
  };
  std::vector<Rates> rates;
  for (int k = 0; k < directions; ++k) rates.push_back(field(direction(k).u));
  const auto at = [&](int k) -> const Rates& {
    return rates[static_cast<std::size_t>((k + directions) % directions)];
  };
  Kink kink{.unit = unit};
  std::vector<bool> has_ray;
  for (int k = 0; k < directions; ++k) {
    const auto ray = ray_at(field, {direction(k + directions - 1).u, direction(k).u, direction(k + 1).u},
                            {at(k - 1), at(k), at(k + 1)});
    has_ray.push_back(ray.has_value());
    if (ray) kink.rays.push_back({ray->direction.cwiseProduct(scale).stableNormalized(), ray->rate});
  }
  // Up to the next ray a motion grows by exp(rise); twice around, since a rise may begin late in a turn.
  double rise = 0, largest_rise = 0;
  for (int k = 0; k < 2 * directions; ++k) {
    const double step = direction(k).width * at(k).radial / std::abs(at(k).angular);
    rise = has_ray[static_cast<std::size_t>(k % directions)] ? 0 : std::max(0.0, rise + step);
    largest_rise = std::max(largest_rise, rise);
  }
  kink.swing = std::exp(largest_rise);
  const auto turn = [&](int step) {
    double time = 0, growth = 0;
    for (int k = 0; k < directions; k += step) {
      const double share = step * direction(k).width / std::abs(at(k).angular);
      time += share;
      growth += share * at(k).radial;
    }
    return std::array{growth / time, time};
  };
  const auto [rate, time] = turn(1);
  kink.rate = rate;
  kink.rate_error = std::abs(rate - turn(2)[0]) + 1e-9 / time;
  kink.frequency = 2 * std::numbers::pi / time;
  return kink;
}

}  // namespace hmax
