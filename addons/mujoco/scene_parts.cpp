#include "addons/mujoco/scene_parts.hpp"

#include <array>
#include <cmath>
#include <cstddef>

namespace hmax::mujoco {
namespace {

using Kind = Part::Kind;

struct Numbers {
  double stiffness = 0, damping = 0;
};

/// Row i of one of its tables.
template <class T>
T* row(T* table, int i, int width) {
  return table + static_cast<std::ptrdiff_t>(i) * width;
}

/// Of a constraint. [MuJoCo, Modeling, Solver parameters]: (time constant, damping ratio) or (-stiffness,
/// -damping), but for the impedance, by which both are divided.
Numbers numbers_of(const mjtNum* reference) {
  const double constant = reference[0], ratio = reference[1];
  if (constant <= 0) return {-constant, -ratio};
  return {ratio > 0 ? 1 / (constant * constant * ratio * ratio) : 0, 2 / constant};
}

void scale_reference(mjtNum* to, const mjtNum* from, Numbers factors) {
  if (from[0] <= 0) {
    to[0] = from[0] * factors.stiffness;
    to[1] = from[1] * factors.damping;
    return;
  }
  to[0] = from[0] / factors.damping;
  to[1] = from[1] * factors.damping / std::sqrt(factors.stiffness);
}

int object_type(Kind kind) {
  switch (kind) {
    case Kind::joint:
    case Kind::joint_limit:
    case Kind::joint_friction:
      return mjOBJ_JOINT;
    case Kind::tendon:
    case Kind::tendon_limit:
    case Kind::tendon_friction:
      return mjOBJ_TENDON;
    case Kind::actuator:
    case Kind::filter:
      return mjOBJ_ACTUATOR;
    case Kind::equality:
      return mjOBJ_EQUALITY;
    case Kind::contact:
      return mjOBJ_GEOM;
    case Kind::pair:
      return mjOBJ_PAIR;
    default:
      return mjOBJ_UNKNOWN;
  }
}

std::string body(const mjModel* m, int id) {
  if (id == 0) return "the world";
  const char* name = mj_id2name(m, mjOBJ_BODY, id);
  return name && *name ? "body " + std::string(name) : "body " + std::to_string(id);
}

/// Its name, or the number that MuJoCo gives it, from 0.
std::string called(const mjModel* m, int type, int id) {
  const char* name = mj_id2name(m, type, id);
  return name && *name ? std::string(name) : std::to_string(id);
}

std::string joint(const mjModel* m, int id) {
  static constexpr std::array<const char*, 4> types{"free", "ball", "slide", "hinge"};
  return std::string(types.at(static_cast<std::size_t>(m->jnt_type[id]))) + " joint of " +
         body(m, m->jnt_bodyid[id]);
}

std::string geom(const mjModel* m, int id) {
  static constexpr std::array<const char*, 8> types{"plane",     "height field", "sphere", "capsule",
                                                    "ellipsoid", "cylinder",     "box",    "mesh"};
  const auto type = static_cast<std::size_t>(m->geom_type[id]);
  return (type < types.size() ? types[type] : "geom") + std::string(" of ") + body(m, m->geom_bodyid[id]);
}

std::string tendon(const mjModel* m, int id) {
  const int first = m->tendon_adr[id], of = m->wrap_objid[first];
  return m->wrap_type[first] == mjWRAP_JOINT ? "fixed to joint " + called(m, mjOBJ_JOINT, of)
                                             : "through site " + called(m, mjOBJ_SITE, of);
}

std::string actuator(const mjModel* m, int id) {
  const int of = row(m->actuator_trnid, id, 2)[0];
  switch (m->actuator_trntype[id]) {
    case mjTRN_JOINT:
    case mjTRN_JOINTINPARENT:
      return "on joint " + called(m, mjOBJ_JOINT, of);
    case mjTRN_TENDON:
      return "on tendon " + called(m, mjOBJ_TENDON, of);
    case mjTRN_BODY:
      return "on " + body(m, of);
    default:
      return "on site " + called(m, mjOBJ_SITE, of);
  }
}

std::string equality(const mjModel* m, int id) {
  const int one = m->eq_obj1id[id], other = m->eq_obj2id[id];
  switch (m->eq_type[id]) {
    case mjEQ_CONNECT:
    case mjEQ_WELD:
      return (m->eq_type[id] == mjEQ_WELD ? "weld of " : "connect of ") + body(m, one) + " and " +
             body(m, other);
    case mjEQ_JOINT:
      return "of joint " + called(m, mjOBJ_JOINT, one);
    case mjEQ_TENDON:
      return "of tendon " + called(m, mjOBJ_TENDON, one);
    default:
      return "constraint";
  }
}

/// Of what has no name.
std::string description(const mjModel* m, Kind kind, int id) {
  switch (object_type(kind)) {
    case mjOBJ_JOINT:
      return joint(m, id);
    case mjOBJ_TENDON:
      return tendon(m, id);
    case mjOBJ_ACTUATOR:
      return actuator(m, id);
    case mjOBJ_EQUALITY:
      return equality(m, id);
    case mjOBJ_GEOM:
      return geom(m, id);
    default:
      return "of " + geom(m, m->pair_geom1[id]) + " and " + geom(m, m->pair_geom2[id]);
  }
}

/// As in the file, or the number from 0 and what it belongs to.
std::string name_of(const mjModel* m, Kind kind, int id) {
  if (kind == Kind::gravity || kind == Kind::viscosity) return "of the scene";
  const char* name = mj_id2name(m, object_type(kind), id);
  return name && *name ? std::string(name) : std::to_string(id) + " (" + description(m, kind, id) + ")";
}

bool is_muscle(const mjModel* m, int i) { return m->actuator_gaintype[i] == mjGAIN_MUSCLE; }

Numbers numbers_of_actuator(const mjModel* m, int i) {
  const mjtNum *gain = row(m->actuator_gainprm, i, mjNGAIN), *bias = row(m->actuator_biasprm, i, mjNBIAS);
  // Its peak force, or the scale of that.
  if (is_muscle(m, i)) return {gain[2] > 0 ? gain[2] : gain[3], 0};
  Numbers numbers;
  if (m->actuator_biastype[i] == mjBIAS_AFFINE) numbers = {0 - bias[1], 0 - bias[2]};  // no -0
  if (m->actuator_gaintype[i] == mjGAIN_AFFINE && numbers.stiffness == 0 && numbers.damping == 0)
    numbers = {0 - gain[1], 0 - gain[2]};
  return numbers;
}

void scale_actuator(mjModel* m, const mjModel* from, int i, Numbers factors) {
  mjtNum *gain = row(m->actuator_gainprm, i, mjNGAIN), *bias = row(m->actuator_biasprm, i, mjNBIAS);
  const mjtNum *gain0 = row(from->actuator_gainprm, i, mjNGAIN),
               *bias0 = row(from->actuator_biasprm, i, mjNBIAS);
  if (is_muscle(from, i)) {
    for (const int k : {2, 3}) {
      gain[k] = gain0[k] * (gain0[k] > 0 ? factors.stiffness : 1);
      bias[k] = bias0[k] * (bias0[k] > 0 ? factors.stiffness : 1);
    }
    return;
  }
  // What a servo of velocity is told is a velocity.
  const bool of_velocity = numbers_of_actuator(from, i).stiffness == 0;
  gain[0] = gain0[0] * (of_velocity ? factors.damping : factors.stiffness);
  bias[0] = bias0[0] * factors.stiffness;
  if (from->actuator_gaintype[i] == mjGAIN_AFFINE) {
    gain[1] = gain0[1] * factors.stiffness;
    gain[2] = gain0[2] * factors.damping;
  }
  bias[1] = bias0[1] * factors.stiffness;
  bias[2] = bias0[2] * factors.damping;
}

/// The rate of the activation.
double rate_of_filter(const mjModel* m, int i) {
  const bool filters = m->actuator_dyntype[i] == mjDYN_FILTER || m->actuator_dyntype[i] == mjDYN_MUSCLE;
  const double constant = row(m->actuator_dynprm, i, mjNDYN)[0];
  return filters && constant > 0 ? 1 / constant : 0;
}

}  // namespace

const char* text_of(Kind kind) {
  static constexpr std::array<const char*, 13> texts{
      "joint",           "joint limit", "joint friction",  "tendon",   "tendon limit",
      "tendon friction", "actuator",    "actuator filter", "equality", "contact",
      "contact pair",    "gravity",     "viscosity"};
  return texts[static_cast<std::size_t>(kind)];
}

std::vector<Part> parts_of(const mjModel* m, std::size_t most) {
  std::vector<Part> parts;
  const auto add = [&](Kind kind, int id, Numbers numbers) {
    if (parts.size() == most || (numbers.stiffness == 0 && numbers.damping == 0)) return;
    parts.push_back({.kind = kind,
                     .id = id,
                     .name = name_of(m, kind, id),
                     .stiffness = numbers.stiffness,
                     .damping = numbers.damping});
  };
  const auto add_constraint = [&](Kind kind, int id, const mjtNum* references, int k) {
    add(kind, id, numbers_of(row(references, k, mjNREF)));
  };
  add(Kind::gravity, 0, {mju_norm3(m->opt.gravity), 0});
  add(Kind::viscosity, 0, {0, m->opt.viscosity});
  for (int i = 0; i < m->njnt; ++i) {
    const int dof = m->jnt_dofadr[i];
    add(Kind::joint, i, {m->jnt_stiffness[i], m->dof_damping[dof]});
    if (m->jnt_limited[i]) add_constraint(Kind::joint_limit, i, m->jnt_solref, i);
    if (m->dof_frictionloss[dof] > 0) add_constraint(Kind::joint_friction, i, m->dof_solref, dof);
  }
  for (int i = 0; i < m->ntendon; ++i) {
    add(Kind::tendon, i, {m->tendon_stiffness[i], m->tendon_damping[i]});
    if (m->tendon_limited[i]) add_constraint(Kind::tendon_limit, i, m->tendon_solref_lim, i);
    if (m->tendon_frictionloss[i] > 0) add_constraint(Kind::tendon_friction, i, m->tendon_solref_fri, i);
  }
  for (int i = 0; i < m->nu; ++i) {
    add(Kind::actuator, i, numbers_of_actuator(m, i));
    add(Kind::filter, i, {0, rate_of_filter(m, i)});
  }
  for (int i = 0; i < m->neq; ++i)
    if (m->eq_active[i]) add_constraint(Kind::equality, i, m->eq_solref, i);
  for (int i = 0; i < m->npair; ++i) add_constraint(Kind::pair, i, m->pair_solref, i);
  for (int i = 0; i < m->ngeom; ++i)
    if (m->geom_contype[i] || m->geom_conaffinity[i]) add_constraint(Kind::contact, i, m->geom_solref, i);
  return parts;
}

void scale(mjModel* m, const mjModel* from, const Part& part, double stiffness, double damping) {
  const int i = part.id;
  const Numbers factors{stiffness, damping};
  const auto reference = [&](mjtNum* to, const mjtNum* of, int k) {
    scale_reference(row(to, k, mjNREF), row(of, k, mjNREF), factors);
  };
  const auto dofs = [&](const auto& change) {
    const int end = i + 1 < from->njnt ? from->jnt_dofadr[i + 1] : from->nv;
    for (int k = from->jnt_dofadr[i]; k < end; ++k) change(k);
  };
  switch (part.kind) {
    case Kind::joint:
      m->jnt_stiffness[i] = from->jnt_stiffness[i] * stiffness;
      return dofs([&](int k) { m->dof_damping[k] = from->dof_damping[k] * damping; });
    case Kind::joint_limit:
      return reference(m->jnt_solref, from->jnt_solref, i);
    case Kind::joint_friction:
      return dofs([&](int k) {
        m->dof_frictionloss[k] = from->dof_frictionloss[k] * stiffness;
        reference(m->dof_solref, from->dof_solref, k);
      });
    case Kind::tendon:
      m->tendon_stiffness[i] = from->tendon_stiffness[i] * stiffness;
      m->tendon_damping[i] = from->tendon_damping[i] * damping;
      return;
    case Kind::tendon_limit:
      return reference(m->tendon_solref_lim, from->tendon_solref_lim, i);
    case Kind::tendon_friction:
      m->tendon_frictionloss[i] = from->tendon_frictionloss[i] * stiffness;
      return reference(m->tendon_solref_fri, from->tendon_solref_fri, i);
    case Kind::actuator:
      return scale_actuator(m, from, i, factors);
    case Kind::filter:
      for (const int k : {0, 1})
        m->actuator_dynprm[i * mjNDYN + k] = from->actuator_dynprm[i * mjNDYN + k] / damping;
      return;
    case Kind::equality:
      return reference(m->eq_solref, from->eq_solref, i);
    case Kind::contact:
      return reference(m->geom_solref, from->geom_solref, i);
    case Kind::pair:
      return reference(m->pair_solref, from->pair_solref, i);
    case Kind::gravity:
      mju_scl3(m->opt.gravity, from->opt.gravity, stiffness);
      return;
    case Kind::viscosity:
      m->opt.viscosity = from->opt.viscosity * damping;
      return;
  }
}

}  // namespace hmax::mujoco
