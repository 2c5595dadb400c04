/// Uses an installed hmax the way a reader of the README would: headers of two folders and one compiled
/// function.
#include <cstdio>
#include <integrators/tableaux.hpp>
#include <results/build_info.hpp>

int main() {
  using Method = hmax::tableaux::DormandPrince54;
  static_assert(hmax::order_of(Method::tableau) == Method::order);
  std::printf("hmax %s: %s has order %d\n", hmax::build_info().version.c_str(), Method::id.data(),
              hmax::order_of(Method::tableau));
}
