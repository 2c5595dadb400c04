/// The limits that are known from elsewhere, for the analysis and for the command.
#pragma once

#include <cmath>
#include <limits>

namespace hmax {

inline constexpr double no_limit = std::numeric_limits<double>::infinity();

struct PublishedLimit {
  const char* method;
  double real, imaginary, weak = NAN;
};

/// First exits from the origin in 128-bit arithmetic, "Stability limits" of docs/reference/facts.md; digits
/// truncated.
inline constexpr PublishedLimit published_limits[]{
    {"explicit_euler", 2, 0, 0.00141421},
    {"rk2_heun", 2, 0, 0.05318297},
    {"rk2_midpoint", 2, 0, 0.05318297},
    {"rk3_kutta", 2.512745326618, 1.732050807569},
    {"bogacki_shampine_32", 2.512745326618, 1.732050807569},
    {"rk4", 2.785293563405, 2.828427124746},
    {"dormand_prince_54", 3.306567892635, 0.997189008633},
    {"adams_bashforth_2", 1, 0},
    {"adams_bashforth_3", 6.0 / 11, 0.723627226987},
    {"adams_bashforth_4", 0.3, 0.429987079909},
    {"abm_pece_2", 2, 1.287188505811},
    {"abm_pece_3", 1.728783568074, 0, 0.0705},
    {"abm_pece_4", 1.284816263107, 0, 0.1362},
    // In 40 digits. Its largest root leaves the circle slowly: 1 + 1e-12 is reached only 2.5e-8 later.
    {"abm_pece_5", 0.946917034538, 0.2587117477},
    {"adams_pece:order=2", 2.4, 1.2},
    {"adams_pece:order=3", 1.934608421157, 1.178471730604},
    {"symplectic_euler", NAN, 2},
    {"velocity_verlet", NAN, 2},
    {"stormer_verlet", NAN, 2},
    {"central_difference", NAN, 2},
    {"explicit_newmark", NAN, 2},
    {"newmark:beta=0.08333333333333333,gamma=0.5", NAN, 2.449489742783178},
    {"newmark:beta=0.16666666666666666,gamma=0.5", NAN, 3.464101615137755},
    {"trapezoidal", no_limit, no_limit},
};

}  // namespace hmax
