/// What the modules of engines share: an object of C++ as a stepper behind hmax/plugin.h.
#pragma once

#include <algorithm>
#include <cstddef>
#include <exception>
#include <string>
#include <vector>

#include "catalogue/plugin/plugin.h"

namespace hmax::engines {

/// A sentence for the user, of the file.
struct Failure {
  std::string text;
};

inline std::string reason;  ///< of the last call that failed

/// A part of a scene, as hmax_part.
struct NamedPart {
  const char* kind;
  std::string name;
  double stiffness = 0, damping = 0;
};

inline constexpr std::size_t most_parts = 10'000;

/// @param calls  returns whether what it does can be done; exceptions become the reason
template <class Calls>
int guarded(const Calls& calls) {
  constexpr int failed = 2;
  try {
    return calls() ? HMAX_OK : HMAX_DIVERGED;
  } catch (const Failure& failure) {
    reason = failure.text;
  } catch (const std::exception& error) {
    reason = error.what();
  }
  return failed;
}

/// The functions of hmax_stepper by those of Engine, of which some are optional:
///   dim(), state(double*), set_state(const double*), bool step(double h), double own_step();
///   saved_size() [numbers], save(double*), restore(const double*); quaternions(), the first index of each;
///   scales(double*);
///   parts(), scale_part(i, stiffness, damping).
template <class Engine>
struct StepperCalls {
  static Engine& of(void* handle) { return *static_cast<Engine*>(handle); }
  static void destroy(void* handle) { delete &of(handle); }
  static const char* error_text(void*) { return reason.c_str(); }
  static int dimension(void* handle, std::size_t* n) {
    *n = of(handle).dim();
    return HMAX_OK;
  }
  static int state(void* handle, double* y) {
    return guarded([&] { return of(handle).state(y), true; });
  }
  static int set_state(void* handle, const double* y) {
    return guarded([&] { return of(handle).set_state(y), true; });
  }
  static int step(void* handle, double h) {
    return guarded([&] { return of(handle).step(h); });
  }
  static int own_step(void* handle, double* h) {
    *h = of(handle).own_step();
    return HMAX_OK;
  }
  static std::size_t saved_size(void* handle) { return sizeof(double) * of(handle).saved_size(); }
  static int save(void* handle, void* blob) {
    return guarded([&] { return of(handle).save(static_cast<double*>(blob)), true; });
  }
  static int restore(void* handle, const void* blob, std::size_t) {
    return guarded([&] { return of(handle).restore(static_cast<const double*>(blob)), true; });
  }
  static int quaternions(void* handle, std::size_t* count, std::size_t* first) {
    const std::vector<std::size_t> all = of(handle).quaternions();
    *count = all.size();
    if (first) std::ranges::copy(all, first);
    return HMAX_OK;
  }
  static int scales(void* handle, double* scale) {
    return guarded([&] { return of(handle).scales(scale), true; });
  }
  static int parts(void* handle, std::size_t* count, hmax_part* to) {
    const std::vector<NamedPart>& all = of(handle).parts();
    *count = all.size();
    if (!to) return HMAX_OK;
    for (const NamedPart& part : all) *to++ = {part.kind, part.name.c_str(), part.stiffness, part.damping};
    return HMAX_OK;
  }
  static int scale_part(void* handle, std::size_t part, double stiffness, double damping) {
    return guarded([&] { return of(handle).scale_part(part, stiffness, damping), true; });
  }

  static constexpr hmax_stepper table(int (*create)(const char*, void**)) {
    hmax_stepper all{};
    all.object = {create, destroy, error_text, dimension};
    all.get_state = state;
    all.set_state = set_state;
    all.step = step;
    all.own_step = own_step;
    if constexpr (requires(Engine & engine) { engine.saved_size(); }) {
      all.saved_size = saved_size;
      all.save = save;
      all.restore = restore;
    }
    if constexpr (requires(Engine & engine) { engine.quaternions(); }) all.quaternions = quaternions;
    if constexpr (requires(Engine & engine, double* scale) { engine.scales(scale); }) all.scales = scales;
    if constexpr (requires(Engine & engine) { engine.parts(); }) {
      all.parts = parts;
      all.scale_part = scale_part;
    }
    return all;
  }
};

}  // namespace hmax::engines
