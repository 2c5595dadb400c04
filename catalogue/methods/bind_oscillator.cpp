#include "catalogue/methods/bind_explicit_rk.hpp"

namespace hmax {

template Runner bind_explicit_rk(std::size_t, const Oscillator&, const Eigen::VectorXd&);
template Runner bind_explicit_rk(const RuntimeTableau&, const Oscillator&, const Eigen::VectorXd&);

}  // namespace hmax
