/// Scenes of other programs as bodies of hmax (catalogue/models/tissue_problem.hpp).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "catalogue/methods/method.hpp"

namespace hmax {

/// The units of all numbers of a file. Files do not say them.
struct SceneUnits {
  double length = 1;  ///< [m]
  double mass = 1;    ///< [kg]
  double time = 1;    ///< [s]
};

/// A body, and how the program that the scene is of steps it.
struct Scene {
  std::string model, load;         ///< parts of tissue_id()
  ProblemSettings settings;        ///< SI, with the unit of the mesh
  std::string integrator;          ///< as the file calls it; empty: none
  std::string method;              ///< of hmax, with its parameters: "hht_alpha:alpha=-0.05"
  std::optional<double> step;      ///< the file's increment [s]
  std::vector<std::string> notes;  ///< sentences: what was left out, and what differs from that program
};

}  // namespace hmax
