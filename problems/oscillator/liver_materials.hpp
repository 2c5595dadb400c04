/// The published table of liver materials: stiffness, damping and mass by sex and build.
#pragma once

#include <span>
#include <stdexcept>
#include <string>
#include <string_view>

#include "problems/oscillator/oscillator.hpp"

namespace hmax {

/// The item of an id. @param what  it is one of
/// @throws std::invalid_argument  naming the known ids
template <class Item>
const Item& liver_item(std::span<const Item> items, std::string_view id, std::string_view what) {
  std::string known;
  for (const Item& item : items) {
    if (item.id == id) return item;
    known.append(known.empty() ? "" : ", ").append(item.id);
  }
  throw std::invalid_argument("there is no liver " + std::string(what) + " '" + std::string(id) +
                              "'; use one of " + known);
}

/// One column of the liver oscillator study's benchmark table.
///
/// Units. The study gives the stiffness in kPa and the damping in N/m^2, then puts the bare numbers into
/// m x'' + c x' + k x: a pressure cannot stand there. A stiffness in N/m would be the modulus times a length
/// (area over thickness of the loaded tissue), which the study does not publish. The house repeats what the
/// study computed: the numbers are taken as N/m and N s/m, and no claim is made that they are those of a
/// liver.
struct LiverMaterial {
  std::string_view id;
  double stiffness;  ///< k1 [N/m], printed as kPa
  double damping;    ///< c [N s/m], printed as N/m^2
  double mass_low;   ///< lower end of the mass range [kg]
  double mass_high;  ///< upper end of the mass range [kg]

  double mass_middle() const { return (mass_low + mass_high) / 2; }
};

/// The six materials in the order of the table: male, then female, each slim, normal, fat.
std::span<const LiverMaterial> liver_materials();

/// The material of an id, a suffix `:light` or `:heavy` left aside.
/// @throws std::invalid_argument  for an unknown id or suffix, naming the known ones
const LiverMaterial& liver_material(std::string_view id);

/// `base` with mass, damping and linear stiffness of a material; k3, P and w stay as they are.
/// @param id  a material id; `:light` and `:heavy` take the ends of the mass range, without them its middle
/// is taken
/// @throws std::invalid_argument  for an unknown id or suffix, naming the known ones
OscillatorParameters with_material(OscillatorParameters base, std::string_view id);

}  // namespace hmax
