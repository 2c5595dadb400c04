/// From bodies on meshes to pictures of them, for every command with --picture.
#pragma once

#include <filesystem>
#include <string>

#include "cli/shared/console.hpp"
#include "cli/shared/options.hpp"
#include "plots/drawn/bodies.hpp"
#include "plots/figure.hpp"
#include "problems/tissue/body.hpp"

namespace hmax {

/// What the colours of a body show.
enum class BodyValue {
  displacement,    ///< length of that of each point [mm]
  energy_density,  ///< at each point the mean over the elements there, weighted with their volumes [J/m^3]
};

/// Columns as points.
std::vector<SpacePoint> space_points(const Eigen::Matrix3Xd& x);
std::vector<TriangleCorners> surface_triangles(const TetMesh& mesh);
/// The points that supports hold.
std::vector<std::int32_t> held_points(const TissueBody& body);
/// What holds them, for a legend: "fixed", "held by springs".
std::string how_held(const TissueBody& body);

/// A state of a body: the deformed shape before that at rest, with supports, dead loads and tools.
BodyView body_view(const TissueBody& body, double t, const Eigen::VectorXd& q, BodyValue value);

/// The scale of such views. That of energies ends where one in fifty points is beyond, when the largest are
/// much larger: at the edge of a support they grow without bound as the mesh is refined.
BodyColours colours_of(BodyValue value, const std::vector<BodyView>& views);

/// A mesh, in the colours of its worst element at each triangle of the surface: one of those that have a
/// corner of it.
BodyView mesh_view(const TetMesh& mesh);
BodyColours mesh_quality_colours();

/// --picture FILE.svg --colour NAME --from X,Y,Z
struct PictureChoice {
  std::string file, colour, from;

  /// @param of_body  there is something to choose to colour
  void add_to(CLI::App& command, const std::string& description, bool of_body = true);
  [[nodiscard]] bool wanted() const { return !file.empty(); }
  /// Throws now what would be thrown after a long computation.
  void check() const;
  void check(const TissueBody& body) const;
  [[nodiscard]] BodyValue value() const;
  /// Writes the picture, seen from --from.
  void write(BodyPicture picture) const;
};

/// @throws InputError  unless the name ends in .svg and the file can be written
void write_picture(const std::filesystem::path& file, const BodyPicture& picture);

}  // namespace hmax
