/// Uses an installed hmax the way a reader of the README would: headers of two folders, one compiled function
/// and an exponential of its own.
#include <cmath>
#include <cstdio>
#include <integrators/explicit/tableaux.hpp>
#include <results/build_info.hpp>

int main(int argc, char**) {
  using Method = hmax::tableaux::DormandPrince54;
  static_assert(hmax::order_of(Method::tableau) == Method::order);
  std::printf("hmax %s: %s has order %d, exp(%d) = %g\n", hmax::build_info().version.c_str(),
              Method::id.data(), hmax::order_of(Method::tableau), argc, std::exp(argc));
}
