#include "studies/scale_study.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>

#include <gtest/gtest.h>

#include "catalogue/device/host_device.hpp"
#include "catalogue/models/problems.hpp"
#include "limits/modes/fastest_mode.hpp"
#include "tests/results/scratch.hpp"

namespace hmax {
namespace {

TEST(ScaleStudy, MeasuresEveryCostOfTheBodyThatItsMeshNames) {
  const Scratch scratch;
  const std::vector<std::string> meshes{"ball:n=2", "cube:n=3"};
  std::vector<std::string> told;
  const auto rows =
      scale_study(meshes, scratch / "new", [&](double, const std::string& mesh) { told.push_back(mesh); });
  ASSERT_EQ(rows.size(), 2U);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const ScaleRow& row = rows[i];
    EXPECT_NE(std::find(told.begin(), told.end(), meshes[i]), told.end());
    // The file is read back as the mesh it was made of, so the body and its fastest mode are the same.
    const Problem problem = make_problem("fem_green@" + meshes[i]);
    EXPECT_EQ(row.tetrahedra, problem.body->mesh().tetrahedron_count());
    EXPECT_EQ(row.dofs, problem.body->dofs());
    EXPECT_NEAR(row.omega, std::sqrt(fastest_mode_of(*problem.body, false).kappa), 1e-5 * row.omega);
    for (const double seconds :
         {row.force, row.stiffness, row.explicit_step, row.implicit_step, row.eigenvalue, row.import}) {
      EXPECT_GT(seconds, 0);
      EXPECT_LT(seconds, 60);
    }
    EXPECT_LT(row.force, row.implicit_step);
    EXPECT_TRUE(std::isnan(row.device_step));
    EXPECT_GT(row.peak_memory, 1e6);
  }
  EXPECT_TRUE(std::filesystem::is_empty(scratch / "new"));
}

TEST(ScaleStudy, TimesTheExplicitStepOfADeviceByItsClock) {
  const Scratch scratch;
  const std::vector<std::string> meshes{"ball:n=2"};
  const auto device = std::make_shared<HostDevice>();
  const auto rows = scale_study(
      meshes, scratch / "new", [](double, const std::string&) {}, device);
  EXPECT_GT(rows.at(0).device_step, 0);
  EXPECT_LT(rows.at(0).device_step, 1);
  EXPECT_EQ(device->seconds(), 0) << "nobody has read the time of its last steps";
}

TEST(ScaleStudy, GoesFromAThousandToAMillionTetrahedra) {
  EXPECT_EQ(scale_meshes().size(), 6U);
  const auto count = [](std::string_view mesh) {
    const double n = std::stod(std::string(mesh.substr(mesh.find('=') + 1)));
    return 20 * n * n * n;
  };
  EXPECT_LT(count(scale_meshes().front()), 2000);
  EXPECT_GE(count(scale_meshes().back()), 1e6);
}

TEST(ScaleStudy, EndsWhereItsProgressSaysSoAndLeavesNoFile) {
  const Scratch scratch;
  const std::vector<std::string> meshes{"ball:n=3"};
  int asked = 0;
  EXPECT_THROW(scale_study(meshes, scratch / "new",
                           [&](double, const std::string&) {
                             if (++asked > 3) throw std::runtime_error("enough");
                           }),
               std::runtime_error);
  EXPECT_TRUE(std::filesystem::is_empty(scratch / "new"));
}

}  // namespace
}  // namespace hmax
