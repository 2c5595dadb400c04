/// hmax as one header, installed as <hmax/hmax.hpp>: what a program of your own needs first. The rest of the
/// library is included by its place, <hmax/integrators/implicit/dirk.hpp>.
#pragma once

#include "integrators/explicit/adaptive.hpp"      // adaptive(): steps steered by the error
#include "integrators/explicit/explicit_rk.hpp"   // Rk, the stepper of all explicit Runge-Kutta methods
#include "integrators/explicit/tableaux.hpp"      // their coefficients: tableaux::Rk4, ...
#include "integrators/explicit/user_tableau.hpp"  // coefficients of your own
#include "integrators/integrate.hpp"              // integrate(), FixedStep
#include "integrators/observers.hpp"              // SampleEvery, EventFinder
#include "limits/largest_stable_step.hpp"         // the largest stable step of a method, as one call
#include "problems/linear_structure.hpp"          // M q'' + C q' + K q = 0 of your own matrices
