#include "catalogue/models/matrix_problem.hpp"

#include <string>

#include <gtest/gtest.h>

#include "core/errors.hpp"

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
    try {
      matrix_files("matrices:" + files);
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_EQ(refusal("jacobian=J.mtx"), "accepted");
  EXPECT_EQ(refusal("stiffness=K.mtx,mass=M.mtx"), "accepted");
  for (const char* matrix : {"stiffness", "mass", "damping"})
    EXPECT_NE(refusal("jacobian=J.mtx," + std::string(matrix) + "=A.mtx").find("give one of them"),
              std::string::npos)
        << matrix;
  EXPECT_NE(refusal("jacobian=J.mtx,drop=constraints").find("applies to stiffness and mass"),
            std::string::npos);
  EXPECT_NE(refusal("stiffness=K.mtx").find("has no mass"), std::string::npos);
  EXPECT_NE(refusal("mass=M.mtx").find("has no stiffness"), std::string::npos);
  EXPECT_NE(refusal("damping=C.mtx").find("has no stiffness"), std::string::npos);
}

}  // namespace
}  // namespace hmax
