#include "catalogue/models/matrix_problem.hpp"

#include <string>

#include <gtest/gtest.h>

#include "core/errors.hpp"
#include "tests/says.hpp"

namespace hmax {
namespace {

TEST(MatrixFiles, AreThoseThatTheirIdNames) {
  const MatrixFiles first = matrix_files("matrices:jacobian=J.mtx,initial=y.txt");
  EXPECT_EQ(first.jacobian, "J.mtx");
  EXPECT_FALSE(first.drop_constraints);
  const MatrixFiles second =
      matrix_files("matrices:stiffness=K.mtx,mass=lumped:M.mtx,damping=C.mtx,drop=constraints");
  EXPECT_EQ(second.stiffness + " " + second.mass + " " + second.damping, "K.mtx M.mtx C.mtx");
  EXPECT_TRUE(second.jacobian.empty());
  EXPECT_TRUE(second.lumped);
  EXPECT_TRUE(second.drop_constraints);
}

TEST(MatrixFiles, ThatMakeNoModelAreRefused) {
  const auto refusal = [](const std::string& files) -> std::string {
    return error_of<InputError>([&] { matrix_files("matrices:" + files); });
  };
  EXPECT_EQ(refusal("jacobian=J.mtx"), "");
  EXPECT_EQ(refusal("stiffness=K.mtx,mass=M.mtx"), "");
  for (const char* matrix : {"stiffness", "mass", "damping"})
    EXPECT_TRUE(says(refusal("jacobian=J.mtx," + std::string(matrix) + "=A.mtx"), "give one of them"))
        << matrix;
  EXPECT_TRUE(says(refusal("jacobian=J.mtx,drop=constraints"), "applies to stiffness and mass"));
  EXPECT_TRUE(says(refusal("stiffness=K.mtx"), "has no mass"));
  EXPECT_TRUE(says(refusal("mass=M.mtx"), "has no stiffness"));
  EXPECT_TRUE(says(refusal("damping=C.mtx"), "has no stiffness"));
}

}  // namespace
}  // namespace hmax
