/// The scenes of SOFA, .scn: nodes in nodes, and components in them with attributes (XML).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "problems/mesh/files/mesh_file.hpp"
#include "problems/mesh/files/mesh_text.hpp"
#include "problems/mesh/files/xml_tags.hpp"

namespace hmax {

/// A node or a component.
struct SofaPart {
  std::string_view type;  ///< "Node", "DiagonalMass"; that of <Object type="DiagonalMass"/>, too
  XmlTag tag;
  std::int64_t place = 0;             ///< its line
  std::optional<std::size_t> node{};  ///< that it is in; none of the root
  [[nodiscard]] std::string_view name() const { return tag.attribute("name"); }
  [[nodiscard]] bool has(std::string_view attribute) const;
};

/// A whole file, which must live as long as this.
class SofaFile {
 public:
  /// @throws std::invalid_argument  where tags are damaged or do not match, and where there is no Node
  SofaFile(const std::string& name, std::string_view bytes);

  [[nodiscard]] const std::string& name() const { return text_.name(); }
  /// In the order of the file; the root first.
  [[nodiscard]] const std::vector<SofaPart>& parts() const { return parts_; }
  /// The first MechanicalObject: the points of the body. @throws std::invalid_argument  where there is none
  [[nodiscard]] const SofaPart& state() const;
  /// Finite numbers with blanks between them. @throws std::invalid_argument  naming the line
  [[nodiscard]] std::vector<double> numbers(const SofaPart& part, std::string_view attribute) const;
  /// `count` of them.
  [[nodiscard]] std::vector<double> numbers(const SofaPart& part, std::string_view attribute,
                                            std::size_t count) const;
  /// The part that a link like "@../box.indices" names, of an attribute that is such a link.
  [[nodiscard]] const SofaPart& linked(const SofaPart& part, std::string_view attribute) const;
  /// Throws "NAME, line N: `text`".
  [[noreturn]] void fail(const SofaPart& part, const std::string& text) const { at(part).fail(text); }
  /// The file, for errors at a part.
  [[nodiscard]] MeshText at(const SofaPart& part) const;

 private:
  MeshText text_;
  std::vector<SofaPart> parts_;
};

/// The name of the group of points that constraints fix.
inline constexpr std::string_view fixed_points_of_sofa = "FixedProjectiveConstraint";

/// What the regions of a body with moduli of each element are made of, region 1 first: each modulus once.
std::vector<double> sorted_moduli(std::vector<double> values);

/// The tetrahedra of the body: those of the topology beside its MechanicalObject, or of the mesh file that a
/// loader names there. @throws std::invalid_argument  one sentence with file, line and remedy
MeshFile sofa_mesh(const SofaFile& file);

}  // namespace hmax
