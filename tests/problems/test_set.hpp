/// All problems of the test set, for suites that are typed by them.
#pragma once

#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "problems/test_set/arenstorf.hpp"
#include "problems/test_set/brusselator.hpp"
#include "problems/test_set/dahlquist.hpp"
#include "problems/test_set/hires.hpp"
#include "problems/test_set/kepler.hpp"
#include "problems/test_set/lorenz.hpp"
#include "problems/test_set/oregonator.hpp"
#include "problems/test_set/pleiades.hpp"
#include "problems/test_set/prothero_robinson.hpp"
#include "problems/test_set/robertson.hpp"
#include "problems/test_set/spring_chain.hpp"
#include "problems/test_set/van_der_pol.hpp"

namespace hmax::test_set {

template <class Real>
using All = ::testing::Types<Dahlquist<Real>, VanDerPol<Real>, Robertson<Real>, Hires<Real>, Pleiades<Real>,
                             Oregonator<Real>, Kepler<Real>, Arenstorf<Real>, Lorenz<Real>, Brusselator<Real>,
                             ProtheroRobinson<Real>, SpringChain<Real>>;

/// The problem with parameters that let every term act: small chains and grids, springs that are cubic too.
template <class Problem>
Problem lively() {
  typename Problem::Parameters p;
  if constexpr (requires {
                  p.k3 = 40;
                  p.c;
                }) {
    p.n = 5;
    p.k3 = 40;
  } else if constexpr (requires { p.n; })
    p.n = 5;
  return Problem(p);
}

/// States near the initial one in which no component is special.
template <class Problem>
std::vector<typename Problem::State> states_of(const Problem& problem, int count) {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> uniform(-0.2, 0.2);
  using Real = typename Problem::State::Scalar;
  std::vector<typename Problem::State> states;
  for (int i = 0; i < count; ++i) {
    typename Problem::State y = problem.y0();
    for (auto& component : y)
      component = component * static_cast<Real>(1 + uniform(random)) + static_cast<Real>(uniform(random));
    states.push_back(y);
  }
  return states;
}

/// A matrix of either kind as a dense one.
template <class Matrix>
auto dense(const Matrix& A) {
  return Eigen::Matrix<typename Matrix::Scalar, Eigen::Dynamic, Eigen::Dynamic>(A);
}

}  // namespace hmax::test_set
