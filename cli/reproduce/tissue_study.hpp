/// What `hmax reproduce tissue` is asked for, and its outcome in numbers.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "studies/scale_study.hpp"
#include "studies/thigh_study.hpp"

namespace hmax {

/// What is made.
struct TissueOptions {
  std::string machine;  ///< one line: where it is done
  bool quick = false;  ///< limits of the step on the phantom and at a few points of each curve, a small thigh
  bool scale = false;  ///< also what meshes of up to a million tetrahedra cost

  /// Whose limits are shown.
  [[nodiscard]] const char* mesh() const { return quick ? "phantom" : "liver"; }
};

/// Explicit steps of the body of springs whose particles have 5 g each.
struct ParticleLimit {
  std::string damping, method;
  double rate = 0;      ///< smallest stable number of steps a second [1/s]; infinity: every step is unstable
  double stiffest = 0;  ///< E up to which 280 steps a second are stable [Pa]; 0 for none
};

/// The least limit of a step on the way of a body under a load.
struct PathLimit {
  std::string load, path, model, method;  ///< path: load or motion
  double at_rest = 0, least = 0;          ///< h_max [s]
  double growing = 0;                     ///< share of the path where the tangent grows
};

/// The outcome in numbers.
struct TissueStudy {
  std::filesystem::path report;   ///< the index.html
  double force_ratio = 0;         ///< cost of the forces on the liver, finite elements over springs
  double step_ratio = 0;          ///< the same of a step of linearly implicit Euler
  double deflection_springs = 0;  ///< largest displacement of the liver under the same load [m]
  double deflection_elements = 0;
  int unsolved = 0;  ///< static ways that did not converge
  std::vector<ParticleLimit> particles;
  double heaviest_particle = 0;  ///< with which that body hangs without an element turned inside out [kg]
  std::vector<PathLimit> paths;
  ThighStudy thigh;
  std::vector<ScaleRow> sizes;  ///< empty unless asked for
};

}  // namespace hmax
