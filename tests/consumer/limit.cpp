/// The largest stable step of two masses, from one header of an installed hmax.
#include <cstdio>
#include <hmax/hmax.hpp>
#include <hmax/integrators/implicit/dirk.hpp>

int main() {
  Eigen::SparseMatrix<double> K(2, 2);  // N/m
  K.insert(0, 0) = 30;
  K.insert(1, 1) = 100;
  const Eigen::Vector2d M(0.01, 0.01);  // kg
  std::puts(describe(hmax::largest_stable_step("rk4", K, M)).c_str());
}
