/// How large a step is stable? Three masses on springs, by your own matrices.
#include <cstdio>
#include <hmax/hmax.hpp>

int main() {
  Eigen::Matrix3d K;  // N/m
  K << 200, -100, 0, -100, 200, -100, 0, -100, 100;
  const Eigen::Vector3d M(0.01, 0.01, 0.01);  // kg
  for (const char* method : {"rk4", "ode45", "symplectic_euler", "newmark"})
    std::puts(describe(hmax::largest_stable_step(method, K, M)).c_str());
}
