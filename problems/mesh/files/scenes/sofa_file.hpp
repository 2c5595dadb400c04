/// The scenes of SOFA, .scn: nodes in nodes, and components in them with attributes.
#pragma once

#include <string_view>
#include <vector>

#include "problems/mesh/files/mesh_file.hpp"
#include "problems/mesh/files/scenes/xml_file.hpp"

namespace hmax {

/// The tag that all others of a scene are in.
inline constexpr std::string_view sofa_root = "Node";

/// The first MechanicalObject: the points of the body. @throws std::invalid_argument  where there is none
const XmlPart& sofa_state(const XmlFile& file);

/// The MechanicalObjects of a file, which must live as long as this.
class SofaStates {
 public:
  explicit SofaStates(const XmlFile& file);
  /// That which acts on a part: in its node, or in the next one above that has one; null where there is none.
  [[nodiscard]] const XmlPart* of(const XmlPart& part) const { return part.node ? in_[*part.node] : nullptr; }

 private:
  std::vector<const XmlPart*> in_;  ///< of each part, as the node that it may be
};

/// The part that a link such as "@../box.indices" names: from the node of the part, where it may be in any
/// node above, or from the root. @throws std::invalid_argument  where there is none
const XmlPart& sofa_linked(const XmlFile& file, const XmlPart& part, std::string_view attribute);

/// Whether a force field of tetrahedra.
bool is_sofa_field(std::string_view type);

/// The name of the group of points that constraints fix.
inline constexpr std::string_view fixed_points_of_sofa = "FixedProjectiveConstraint";

/// What the regions of a body with moduli of each element are made of, region 1 first: each modulus once.
std::vector<double> sorted_moduli(std::vector<double> values);

/// The tetrahedra of the body: those of the topology beside its MechanicalObject, or of the mesh file that a
/// loader names there. Regions are the moduli of a force field, or the nodes in that of the body that have a
/// force field on their own tetrahedra, in their order from 1. @throws std::invalid_argument  one sentence
/// with file, line and remedy
MeshFile sofa_mesh(const XmlFile& file);

}  // namespace hmax
