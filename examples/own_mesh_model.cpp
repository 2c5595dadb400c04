/// A mesh model of your own: finite elements of a tissue that stiffens exponentially. How large a step is
/// stable at rest, and under three times its weight?
#include <cmath>
#include <cstdio>
#include <hmax/hmax.hpp>

#include "problems/mesh/mesh_generators.hpp"
#include "problems/tissue/body.hpp"
#include "problems/tissue/forces/tet_elements.hpp"

/// W = mu/a (exp(a E:E) - 1) + lambda/2 tr(E)^2 of Green's strain E at the displacement gradient H.
class Exponential {
 public:
  Exponential(const Eigen::Matrix3d& H, const hmax::Lame& lame)
      : lambda_(lame.lambda),
        F_(H + Eigen::Matrix3d::Identity()),
        E_((H + H.transpose() + H.transpose() * H) / 2) {
    mu_ = lame.mu * std::exp(a * E_.squaredNorm());
    S_ = 2 * mu_ * E_ + lambda_ * E_.trace() * Eigen::Matrix3d::Identity();
    energy_ = (mu_ - lame.mu) / a + lambda_ / 2 * E_.trace() * E_.trace();
  }
  double energy() const { return energy_; }
  Eigen::Matrix3d stress() const { return F_ * S_; }
  Eigen::Matrix3d differential(const Eigen::Matrix3d& dF) const {
    const Eigen::Matrix3d dE = (F_.transpose() * dF + dF.transpose() * F_) / 2;
    const double along = 2 * a * E_.cwiseProduct(dE).sum();
    return dF * S_ + F_ * (2 * mu_ * (dE + along * E_) + lambda_ * dE.trace() * Eigen::Matrix3d::Identity());
  }

 private:
  static constexpr double a = 20;
  double lambda_, mu_, energy_;
  Eigen::Matrix3d F_, E_, S_;
};

int main() {
  using namespace hmax;
  TissueSettings settings{.model = {.id = "exponential"}, .gravity = {0, -3 * 9.81, 0}};
  settings.model.make_elements = [](const TetMesh& mesh, std::span<const Lame> lame,
                                    const BlockPattern& pattern) -> std::shared_ptr<const Elements> {
    return std::make_shared<TetElements<Exponential>>(mesh, lame, pattern);
  };
  const TetMesh mesh = beam_mesh(0.1, 0.03, 0.03, 3);  // m
  settings.supports = {{.points = points_in_box(mesh, {0, 0, 0}, {0, 0.03, 0.03})}};
  const TissueBody body(mesh, settings);
  std::puts(describe(largest_stable_step("rk4", body, body.y0())).c_str());
  std::puts(describe(largest_stable_step("rk4", body, body.y0(), {.find_equilibrium = true})).c_str());
}
