/// A body cut into patches of points, for body_step().
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "catalogue/device/patches/patch_arrays.hpp"
#include "problems/tissue/body.hpp"

namespace hmax {

/// Why a body cannot be stepped by body_step(), "has ..."; empty where it can.
std::string unsuited_for_patches(const TissueBody& body);

/// The arrays of BodyArrays, as they are copied to a device.
struct BodyPatches {
  std::vector<PatchBegin> begin;
  std::vector<std::int32_t> rim;
  std::vector<PatchCorners> corners;
  std::vector<double> gradients, half_lambda, mu;
  TetLaw law = TetLaw::green;
  PatchElements elements = PatchElements::tetrahedra;
  std::vector<PatchTenNodes> ten_nodes;
  std::vector<BodyTetrahedron> tetrahedra;  ///< of the body, where they share pressures; else empty
  std::vector<double> volume;
  std::vector<PatchAverages> averages;
  std::vector<std::int32_t> average, average_ends, among;
  std::vector<double> average_lambda, average_volume;
  std::vector<PatchCorners> fibre_corners;
  std::vector<double> fibre;
  bool fibres_of_small_strain = false;
  std::vector<PatchSpring> ends;
  std::vector<double> per_length, tension, rest;
  std::vector<std::int32_t> set_begin;
  std::vector<PatchSpring> damped;
  std::vector<double> damper;
  std::vector<PatchTriangle> skin;
  std::vector<double> skin_gradients, skin_volume;
  double skin_modulus = 0, skin_poisson = 0;
  std::vector<PatchContact<double>> contacts;
  std::vector<PointSlots> slots;
  std::vector<SlotGroup> groups;
  std::vector<std::uint16_t> push_slot;
  std::vector<std::int32_t> push_load;
  std::vector<double> push_share, weight, drag, mass, anchor;
  std::vector<std::vector<Support>> motions;  ///< of supports that move, without their points
  std::vector<std::int32_t> moved_by;
  std::vector<TimeProfile> rates;  ///< of supports that drag free points
  std::vector<double> support_drag;
  std::vector<std::int32_t> damped_by, damp_end;
  std::vector<double> damping;
  double watch = 0;
  std::int32_t points = 0;
  std::vector<std::int32_t> order;   ///< of each free point of the body: its number here
  std::vector<std::int32_t> number;  ///< of each point of the mesh, likewise
  std::size_t shared = 0;            ///< shared_numbers() of the patch that needs most

  [[nodiscard]] std::int32_t free() const { return static_cast<std::int32_t>(mass.size()); }
};

/// Patches of about `points` points each, by halves along the longest side of the box around them.
/// @param body  one that suits
/// @param most_shared  numbers that a block may share; patches become smaller until they fit
/// @throws InputError  where one point alone does not fit
BodyPatches body_patches(const TissueBody& body, std::size_t points = 128, std::size_t most_shared = 1 << 20);

}  // namespace hmax
