/// A robot of a file in URDF, as Bullet's own importer takes it.
#pragma once

#include <LinearMath/btTransform.h>
#include <string>
#include <vector>

namespace hmax::bullet {

struct Urdf {
  /// About the centre of mass, in the frame of its principal axes. Without <inertial> Bullet takes 1 kg and
  /// 1 kg m^2, but for the link "world", which is fixed.
  struct Link {
    std::string name;
    bool has_inertial = true;
    double mass = 1;                                    ///< [kg]
    btVector3 inertia{1, 1, 1};                         ///< principal moments [kg m^2]
    btTransform inertial = btTransform::getIdentity();  ///< that frame in the frame of the link
  };
  enum class Type { fixed, turning, sliding };
  /// To the link with its number plus one.
  struct Joint {
    std::string name;
    Type type = Type::fixed;
    int parent = 0;  ///< a link before
    btTransform origin = btTransform::getIdentity();
    btVector3 axis{1, 0, 0};
    double lower = 0, upper = -1;  ///< [rad], [m]; none where they are this way round
    double damping = 0;            ///< [N m s/rad], [N s/m]
  };
  std::vector<Link> links;    ///< the base first
  std::vector<Joint> joints;  ///< one less
};

/// @throws engines::Failure  with the line, for what Bullet or this module does not understand
Urdf read_urdf(const std::string& file);

}  // namespace hmax::bullet
