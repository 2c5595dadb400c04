#include "bench/bind_explicit_rk.hpp"

namespace hmax {

template Runner bind_explicit_rk(std::size_t, const FormulaSystem&, const Eigen::VectorXd&);
template Runner bind_explicit_rk(const RuntimeTableau&, const FormulaSystem&, const Eigen::VectorXd&);

}  // namespace hmax
