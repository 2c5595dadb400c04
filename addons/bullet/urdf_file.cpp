#include "addons/bullet/urdf_file.hpp"

#include <LinearMath/btMatrix3x3.h>
#include <algorithm>
#include <array>
#include <fstream>
#include <iterator>
#include <map>
#include <string_view>
#include <utility>

#include "addons/stepper.hpp"
#include "problems/mesh/files/scenes/xml_file.hpp"

namespace hmax::bullet {
namespace {

using engines::Failure;
using Names = std::initializer_list<std::string_view>;

class Reader {
 public:
  Reader(const std::string& name, std::string text) : text_(std::move(text)), file_(name, text_, "robot") {}
  [[nodiscard]] Urdf robot() const;

 private:
  /// Elements that stand in none of the lists.
  void refuse_others(const XmlPart& part, Names taken, Names passed_over) const;
  [[nodiscard]] std::string name_of(const XmlPart& part) const;
  /// The attribute as `count` numbers; those of `otherwise` where it, or the part, is missing.
  template <std::size_t count>
  [[nodiscard]] std::array<double, count> numbers(const XmlPart* part, std::string_view attribute,
                                                  std::array<double, count> otherwise) const;
  [[nodiscard]] double number(const XmlPart* part, std::string_view attribute, double otherwise) const {
    return numbers<1>(part, attribute, {otherwise})[0];
  }
  [[nodiscard]] std::string link_of(const XmlPart& joint, std::string_view type) const;
  [[nodiscard]] btTransform origin(const XmlPart* part) const;
  [[nodiscard]] Urdf::Link link(const XmlPart& part) const;
  [[nodiscard]] Urdf::Joint joint(const XmlPart& part) const;

  std::string text_;
  XmlFile file_;
};

void Reader::refuse_others(const XmlPart& part, Names taken, Names passed_over) const {
  const auto holds = [](Names names, std::string_view name) {
    return std::ranges::find(names, name) != names.end();
  };
  for (const XmlPart* each : file_.within(part))
    if (!holds(taken, each->type) && !holds(passed_over, each->type))
      file_.fail(*each, "<" + std::string(each->type) + "> in <" + std::string(part.type) +
                            "> is not understood; remove it");
}

std::string Reader::name_of(const XmlPart& part) const {
  std::string name = unescaped(part.name());
  if (name.empty()) file_.fail(part, "<" + std::string(part.type) + "> has no name; give it one");
  return name;
}

template <std::size_t count>
std::array<double, count> Reader::numbers(const XmlPart* part, std::string_view attribute,
                                          std::array<double, count> otherwise) const {
  if (!part || !part->has(attribute)) return otherwise;
  std::array<double, count> values{};
  std::ranges::copy(file_.numbers(*part, attribute, count), values.begin());
  return values;
}

std::string Reader::link_of(const XmlPart& joint, std::string_view type) const {
  const XmlPart* const part = file_.first(joint, type);
  return part ? unescaped(part->tag.attribute("link")) : std::string();
}

btTransform Reader::origin(const XmlPart* part) const {
  const auto [x, y, z] = numbers<3>(part, "xyz", {});
  const auto [roll, pitch, yaw] = numbers<3>(part, "rpy", {});
  btQuaternion turn;
  turn.setEulerZYX(yaw, pitch, roll);
  return btTransform(turn, btVector3(x, y, z));
}

Urdf::Link Reader::link(const XmlPart& part) const {
  refuse_others(part, {"inertial", "contact"}, {"visual", "collision", "audio_source"});
  Urdf::Link link;
  link.name = name_of(part);
  const XmlPart* const inertial = file_.first(part, "inertial");
  link.has_inertial = inertial || link.name == "world";
  if (inertial) {
    refuse_others(*inertial, {"origin", "mass", "inertia"}, {});
    const XmlPart* const mass = file_.first(*inertial, "mass");
    const XmlPart* const inertia = file_.first(*inertial, "inertia");
    for (const auto& [given, attribute] :
         {std::pair(mass, "value"), {inertia, "ixx"}, {inertia, "iyy"}, {inertia, "izz"}})
      if (!given || !given->has(attribute))
        file_.fail(*inertial, "<inertial> of link '" + link.name + "' has no " + attribute + "; give it");
    link.mass = number(mass, "value", 0);
    const double ixx = number(inertia, "ixx", 0), iyy = number(inertia, "iyy", 0),
                 izz = number(inertia, "izz", 0), ixy = number(inertia, "ixy", 0),
                 ixz = number(inertia, "ixz", 0), iyz = number(inertia, "iyz", 0);
    if (link.mass < 0 || ixx < 0 || iyy < 0 || izz < 0)
      file_.fail(*inertial, "link '" + link.name + "' has a negative mass or moment of inertia; correct it");
    btMatrix3x3 moments(ixx, ixy, ixz, ixy, iyy, iyz, ixz, iyz, izz), axes = btMatrix3x3::getIdentity();
    if (ixy != 0 || ixz != 0 || iyz != 0) moments.diagonalize(axes, 1e-6, 30);
    link.inertia = {moments[0][0], moments[1][1], moments[2][2]};
    link.inertial = origin(file_.first(*inertial, "origin"));
    link.inertial.setBasis(link.inertial.getBasis() * axes);
  } else if (link.name == "world") {
    link.mass = 0;
    link.inertia.setZero();
  }
  if (const XmlPart* const contact = file_.first(part, "contact"))
    link.inertia *= number(file_.first(*contact, "inertia_scaling"), "value", 1);
  return link;
}

Urdf::Joint Reader::joint(const XmlPart& part) const {
  refuse_others(part, {"origin", "parent", "child", "axis", "limit", "dynamics"},
                {"mimic", "calibration", "safety_controller"});
  Urdf::Joint joint;
  joint.name = name_of(part);
  const std::string_view type = part.tag.attribute("type");
  if (type == "revolute" || type == "continuous")
    joint.type = Urdf::Type::turning;
  else if (type == "prismatic")
    joint.type = Urdf::Type::sliding;
  else if (type != "fixed")
    file_.fail(part, "joint '" + joint.name + "' is of type '" + std::string(type) +
                         "'; revolute, continuous, prismatic and fixed ones are understood");
  joint.origin = origin(file_.first(part, "origin"));
  const auto [x, y, z] = numbers<3>(file_.first(part, "axis"), "xyz", {1, 0, 0});
  joint.axis = {x, y, z};
  if (joint.type != Urdf::Type::fixed && joint.axis.fuzzyZero())
    file_.fail(part, "the axis of joint '" + joint.name + "' has no length; correct it");
  const XmlPart* const limit = file_.first(part, "limit");
  // Bullet's importer limits no continuous joint.
  if (limit && type != "continuous")
    joint.lower = number(limit, "lower", 0), joint.upper = number(limit, "upper", -1);
  joint.damping = number(file_.first(part, "dynamics"), "damping", 0);
  return joint;
}

Urdf Reader::robot() const {
  const XmlPart& root = file_.parts().front();
  refuse_others(root, {"link", "joint"}, {"material", "transmission", "gazebo", "sensor"});
  std::map<std::string, const XmlPart*> links, parents;  // by the name of the link
  std::map<std::string, std::vector<const XmlPart*>> below;
  for (const XmlPart* each : file_.all(root, "link"))
    if (!links.emplace(name_of(*each), each).second)
      file_.fail(*each, "link '" + name_of(*each) + "' is there twice; remove one");
  for (const XmlPart* each : file_.all(root, "joint")) {
    const std::string parent = link_of(*each, "parent"), child = link_of(*each, "child");
    for (const std::string& name : {parent, child})
      if (!links.contains(name))
        file_.fail(*each, "joint '" + name_of(*each) + "' has no link '" + name + "'; correct its name");
    if (!parents.emplace(child, each).second)
      file_.fail(*each, "link '" + child + "' has two parents; remove one");
    below[parent].push_back(each);
  }
  Urdf robot;
  std::vector<std::pair<std::string, int>> open;  // links whose joints are to be taken, and their numbers
  for (const auto& [name, node] : links) {
    if (parents.contains(name)) continue;
    if (!open.empty())
      file_.fail(*node, "link '" + name + "' has no parent, as link '" + open.front().first + "'; join them");
    open.emplace_back(name, 0);
    robot.links.push_back(link(*node));
  }
  if (robot.links.empty()) throw Failure{links.empty() ? "it has no link" : "its links form a circle"};
  while (!open.empty()) {
    const auto [name, number] = open.back();
    open.pop_back();
    for (const XmlPart* each : below[name]) {
      const std::string child = link_of(*each, "child");
      open.emplace_back(child, static_cast<int>(robot.links.size()));
      robot.links.push_back(link(*links[child]));
      robot.joints.push_back(joint(*each));
      robot.joints.back().parent = number;
    }
  }
  if (robot.links.size() < links.size()) file_.fail(root, "its links form a circle; open it");
  return robot;
}

}  // namespace

Urdf read_urdf(const std::string& file) {
  std::ifstream stream(file, std::ios::binary);
  const std::string text(std::istreambuf_iterator<char>(stream), {});
  return Reader("the robot", text).robot();
}

}  // namespace hmax::bullet
