/// The mesh of a flexcomp of MuJoCo, with the points that it pins.
#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <set>

#include <Eigen/Geometry>

#include "core/text/split.hpp"
#include "problems/mesh/files/mesh_readers.hpp"
#include "problems/mesh/files/scenes/mujoco_file.hpp"

namespace hmax {

namespace {

using Index = TetMesh::Index;

class FlexcompReader {
 public:
  explicit FlexcompReader(const XmlFile& file) : file_(file), flex_(mujoco_flexcomp(file)) {}

  MeshFile read() {
    if (const std::string_view dim = flex_.tag.attribute("dim", "2"); dim != "3")
      file_.fail(flex_, "the flexcomp has dim " + in_quotes(dim) + ", and bodies of dim 3 are read");
    const std::string_view type = flex_.tag.attribute("type", "grid");
    if (!is_listed(type, "grid|direct|gmsh"))
      file_.fail(flex_, "the flexcomp is of type " + in_quotes(type) +
                            ", and grid, direct and gmsh are read; mesh the body and name its .msh");
    MeshFile mesh = type == "grid"     ? grid()
                    : type == "direct" ? listed_mesh(file_, {flex_, "point"}, {flex_, "element"}, "MuJoCo")
                                       : from_gmsh();
    place(mesh.mesh, type != "grid");
    pin(mesh);
    mesh.material = file_.place_of_first([](const XmlPart& part) { return part.type == "elasticity"; });
    return mesh;
  }

 private:
  [[nodiscard]] std::vector<double> given(const XmlPart& part, std::string_view attribute,
                                          const std::vector<double>& otherwise) const {
    return part.has(attribute) ? file_.numbers(part, attribute, otherwise.size()) : otherwise;
  }

  [[nodiscard]] std::vector<std::int64_t> integers(const XmlPart& part, std::string_view attribute) const {
    const std::string what(attribute);
    std::vector<std::int64_t> found;
    for (MeshText rest = file_.values(part, part.tag.attribute(attribute)); !rest.at_end();)
      found.push_back(rest.integer(what.c_str()));
    return found;
  }

  /// Points along z first, then y, then x; each box is six tetrahedra about one of its diagonals.
  MeshFile grid() {
    constexpr double most = 1e7;
    count_ = {10, 10, 10};
    if (flex_.has("count")) {
      const std::vector<std::int64_t> counts = integers(flex_, "count");
      if (counts.size() != 3) file_.fail(flex_, "count is not three numbers; correct it");
      std::ranges::copy(counts, count_.begin());
    }
    const std::vector<double> spacing = given(flex_, "spacing", {0.02, 0.02, 0.02});
    if (std::ranges::any_of(count_, [](std::int64_t n) { return n < 2; }))
      file_.fail(flex_, "a count is below 2, so that there is no tetrahedron; correct it");
    if (std::ranges::any_of(spacing, [](double s) { return !(s > 0); }))
      file_.fail(flex_, "a spacing is not positive; correct it");
    if (static_cast<double>(count_[0]) * static_cast<double>(count_[1]) * static_cast<double>(count_[2]) >
        most)
      file_.fail(flex_, "the grid has more than 1e7 points; give a smaller count");
    MeshBuilder builder;
    const auto along = [&](std::size_t axis, std::int64_t i) {
      return spacing[axis] * (static_cast<double>(i) - 0.5 * static_cast<double>(count_.at(axis) - 1));
    };
    for (std::int64_t i = 0; i < count_[0]; ++i)
      for (std::int64_t j = 0; j < count_[1]; ++j)
        for (std::int64_t k = 0; k < count_[2]; ++k) builder.add_point(along(0, i), along(1, j), along(2, k));
    // From (1, 0, 0) to (0, 1, 1), and around it.
    constexpr std::array<std::array<int, 3>, 7> around{
        {{0, 0, 0}, {0, 1, 0}, {1, 1, 0}, {1, 1, 1}, {1, 0, 1}, {0, 0, 1}, {0, 0, 0}}};
    std::int64_t number = 0;
    for (std::int64_t i = 0; i + 1 < count_[0]; ++i)
      for (std::int64_t j = 0; j + 1 < count_[1]; ++j)
        for (std::int64_t k = 0; k + 1 < count_[2]; ++k)
          for (std::size_t s = 0; s + 1 < around.size(); ++s) {
            const auto corner = [&](const std::array<int, 3>& c) {
              return point(i + c[0], j + c[1], k + c[2]);
            };
            builder.add_tetrahedron(
                {corner({0, 1, 1}), corner({1, 0, 0}), corner(around.at(s)), corner(around.at(s + 1))},
                number++, flex_.place, 0, file_.at(flex_));
          }
    return builder.finish(file_.at(flex_), "MuJoCo");
  }

  [[nodiscard]] Index point(std::int64_t i, std::int64_t j, std::int64_t k) const {
    return static_cast<Index>((i * count_[1] + j) * count_[2] + k);
  }

  /// A mesh beside the model, or in the folder that the compiler names.
  MeshFile from_gmsh() {
    std::filesystem::path folder = std::filesystem::path(file_.name()).parent_path();
    for (const XmlPart* compiler : file_.all(file_.parts().front(), "compiler"))
      for (const char* of : {"assetdir", "meshdir"})
        if (compiler->has(of))
          folder = std::filesystem::path(file_.name()).parent_path() / unescaped(compiler->tag.attribute(of));
    const std::filesystem::path path = folder / unescaped(flex_.tag.attribute("file"));
    if (lower(path.extension().string()) != ".msh")
      file_.fail(flex_, "a flexcomp of type gmsh takes a .msh, and not " + in_quotes(path.string()));
    std::error_code ignored;
    if (!std::filesystem::exists(path, ignored))
      file_.fail(flex_, "there is no file " + in_quotes(path.string()) + "; correct its name");
    return read_mesh_file(path);
  }

  /// The place and turn of a part in the one around it.
  [[nodiscard]] Eigen::Isometry3d pose(const XmlPart& part) const {
    for (const char* other : {"axisangle", "xyaxes", "zaxis", "euler"})
      if (part.has(other))
        file_.fail(part,
                   std::string(other) + " of " + std::string(part.type) + " is not read; write it as quat");
    const std::vector<double> at = given(part, "pos", {0, 0, 0}), q = given(part, "quat", {1, 0, 0, 0});
    const Eigen::Quaterniond turn(q[0], q[1], q[2], q[3]);
    if (!(turn.norm() > 1e-9)) file_.fail(part, "quat has no length; correct it");
    return Eigen::Translation3d(at[0], at[1], at[2]) * turn.normalized();
  }

  void place(TetMesh& mesh, bool scales) const {
    const std::vector<double> scale = scales ? given(flex_, "scale", {1, 1, 1}) : std::vector<double>(3, 1);
    if (std::ranges::any_of(scale, [](double s) { return !(s > 0); }))
      file_.fail(flex_, "a scale is not positive; correct it");
    Eigen::Isometry3d all = pose(flex_);
    for (const XmlPart* above = file_.parent(flex_); above && is_listed(above->type, "body|frame");
         above = file_.parent(*above))
      all = pose(*above) * all;
    const Eigen::Affine3d map = all * Eigen::Scaling(scale[0], scale[1], scale[2]);
    mesh.points = ((map.linear() * mesh.points).colwise() + map.translation()).eval();
  }

  void pin(MeshFile& mesh) {
    std::set<Index> pinned;
    const auto add = [&](const XmlPart& part, std::int64_t number) {
      if (number < 0 || number >= mesh.mesh.point_count())
        file_.fail(part, "there is no point " + std::to_string(number) + " to pin; points count from 0");
      pinned.insert(static_cast<Index>(number));
    };
    for (const XmlPart* each : file_.all(flex_, "pin")) {
      const XmlPart& part = *each;
      for (const std::int64_t number : integers(part, "id")) add(part, number);
      for (const auto& [from, to] : spans(part, "range", 1)) {
        add(part, to[0]);
        for (std::int64_t number = from[0]; number <= to[0]; ++number) add(part, number);
      }
      if ((part.has("grid") || part.has("gridrange")) && count_[0] == 0)
        file_.fail(part, "grid and gridrange are of a flexcomp of type grid; pin by id");
      std::vector<Span> boxes = spans(part, "gridrange", 3);
      const std::vector<std::int64_t> single = integers(part, "grid");
      if (single.size() % 3 != 0) file_.fail(part, "grid is not three numbers of each point; correct it");
      for (std::size_t i = 0; i < single.size(); i += 3) {
        const std::array<std::int64_t, 3> at{single[i], single[i + 1], single[i + 2]};
        boxes.emplace_back(at, at);
      }
      for (const auto& [from, to] : boxes) {
        for (std::size_t axis = 0; axis < 3; ++axis)
          if (from.at(axis) < 0 || to.at(axis) >= count_.at(axis))
            file_.fail(part, "a place in the grid is outside of count, from 0 on; correct it");
        for (std::int64_t i = from[0]; i <= to[0]; ++i)
          for (std::int64_t j = from[1]; j <= to[1]; ++j)
            for (std::int64_t k = from[2]; k <= to[2]; ++k) pinned.insert(point(i, j, k));
      }
    }
    add_points_group(mesh, mujoco_pinned, pinned);
  }

  using Span = std::pair<std::array<std::int64_t, 3>, std::array<std::int64_t, 3>>;
  /// First and last places, of `axes` numbers each.
  [[nodiscard]] std::vector<Span> spans(const XmlPart& part, std::string_view attribute,
                                        std::size_t axes) const {
    const std::vector<std::int64_t> numbers = integers(part, attribute);
    if (numbers.size() % (2 * axes) != 0)
      file_.fail(part, std::string(attribute) + " is not a first and a last place each; correct it");
    std::vector<Span> found;
    for (std::size_t i = 0; i < numbers.size(); i += 2 * axes) {
      Span span{};
      std::copy_n(numbers.begin() + static_cast<std::ptrdiff_t>(i), axes, span.first.begin());
      std::copy_n(numbers.begin() + static_cast<std::ptrdiff_t>(i + axes), axes, span.second.begin());
      for (std::size_t axis = 0; axis < axes; ++axis)
        if (span.first.at(axis) > span.second.at(axis))
          file_.fail(part, std::string(attribute) + " ends before it begins; give the first place first");
      found.push_back(span);
    }
    return found;
  }

  const XmlFile& file_;
  const XmlPart& flex_;
  std::array<std::int64_t, 3> count_{};  // of a grid
};

}  // namespace

const XmlPart& mujoco_flexcomp(const XmlFile& file) {
  const XmlPart* found = nullptr;
  for (const XmlPart& part : file.parts()) {
    if (part.type != "flexcomp") continue;
    if (found) file.fail(part, "there is a second flexcomp, and bodies are of one; remove one");
    found = &part;
  }
  if (!found)
    file.fail(
        file.parts().front(),
        "there is no flexcomp, which is what is read of a model of MuJoCo; `hmax probe` takes all of it");
  return *found;
}

MeshFile mujoco_mesh(const XmlFile& file) { return FlexcompReader(file).read(); }

MeshFile read_mujoco(const std::string& name, std::string_view text) {
  return mujoco_mesh(XmlFile(name, text, mujoco_root));
}

}  // namespace hmax
