/// hmax fidelity: its document, its table and its errors.
#include <cmath>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/cli/program.hpp"

namespace hmax {
namespace {

TEST(FidelityCommand, TellsStiffnessDampingAndTheModulusToEnter) {
  const nlohmann::json document = Shell{}.json(
      "fidelity --mesh phantom --load press --model fem_neo_hookean --rate 60 --method vbd:iterations=3 "
      "--method implicit_euler --verify --enter 5kPa");
  EXPECT_EQ(document["model"], "fem_neo_hookean/press@phantom");
  EXPECT_EQ(document["rate"], 60);
  ASSERT_EQ(document["rows"].size(), 2U);
  const nlohmann::json &vbd = document["rows"][0], &exact = document["rows"][1];
  EXPECT_EQ(vbd["options"]["iterations"], 3);
  EXPECT_DOUBLE_EQ(vbd["h"], 1.0 / 60);
  EXPECT_LT(vbd["stiffness_shown"], 0.9);
  EXPECT_GT(vbd["modulus_to_enter"], 5000);
  EXPECT_GT(vbd["stiffness_ceiling"], 5000);
  EXPECT_EQ(vbd["modes"].size(), 3U);
  EXPECT_LT(vbd["gap"], 0.02);
  EXPECT_NEAR(vbd["observed"]["stiffness_shown"].get<double>(), vbd["stiffness_shown"].get<double>(), 0.01);
  EXPECT_NEAR(exact["stiffness_shown"].get<double>(), 1, 1e-6);
  EXPECT_EQ(exact["stiffness_ceiling"], "unbounded");
  EXPECT_NEAR(exact["modulus_to_enter"].get<double>(), 5000, 1);
}

TEST(FidelityCommand, MapsOneMethodOverItsWork) {
  const Shell shell;
  const Told told = shell.hmax(
      "fidelity --mesh cube:n=1 --load press --model fem_neo_hookean --rate 60 --method xpbd:reset=1 --map "
      "iterations,substeps --output map.svg --json");
  ASSERT_EQ(told.exit_code, 0) << told.err;
  const nlohmann::json rows = told.json()["rows"];
  ASSERT_EQ(rows.size(), 26U);
  for (const nlohmann::json& row : rows) {
    EXPECT_LE(row["iterations"].get<int>() * row["substeps"].get<int>(), 200);
    EXPECT_EQ(row["options"]["iterations"], row["iterations"]);
    EXPECT_EQ(row["options"]["reset"], 1);
  }
  EXPECT_EQ(rows[7]["iterations"], 2);
  EXPECT_EQ(rows[7]["substeps"], 2);
  // A row is that of its own method.
  const nlohmann::json alone = shell.json(
      "fidelity --mesh cube:n=1 --load press --model fem_neo_hookean --rate 60 "
      "--method xpbd:iterations=2,substeps=2,reset=1 --method rk4")["rows"];
  EXPECT_EQ(alone[0], rows[7]);
  EXPECT_TRUE(alone[1]["iterations"].is_null());
  if (!told.err.empty()) GTEST_SKIP() << told.err;  // without gnuplot
  const std::string svg = read_text(shell / "map.svg");
  for (const char* words : {"Stiffness", "Damping", "1 substep", "20 substeps", "iterations × substeps"})
    EXPECT_TRUE(says(svg, words));
}

TEST(FidelityCommand, TakesEveryModelWithPositionsAndVelocities) {
  const Shell shell;
  const nlohmann::json oscillator =
      shell.json("fidelity --problem liver_cubic --rate 10 --method implicit_euler --verify");
  EXPECT_EQ(oscillator["model"], "liver_cubic");
  const nlohmann::json& row = oscillator["rows"][0];
  EXPECT_NEAR(row["stiffness_shown"].get<double>(), 1, 1e-9);
  EXPECT_LT(row["gap"], 1e-3);
  for (const char* of_bodies : {"stiffness_ceiling", "modulus_to_enter", "volume_kept"})
    EXPECT_TRUE(row[of_bodies].is_null()) << of_bodies;
  EXPECT_TRUE(row["momentum_made"]["linear"].is_null());
  // Those of simulators that take it.
  const nlohmann::json all = shell.json("fidelity --problem spring_chain --rate 1000")["rows"];
  ASSERT_EQ(all.size(), 3U);
  EXPECT_TRUE(all[0]["stiffness_shown"].is_null());
  EXPECT_TRUE(says(all[0]["status"].get<std::string>(), "nothing loads the model in its start"));
  EXPECT_EQ(all[0]["modes"].size(), 3U);

  // Small motions of the pendulum of the example in C, about its rest: the load is the force where it is
  // held.
  const std::string plugin =
      shell.text("fidelity --plugin " EXAMPLE_MODEL " --rate 100 --method rk4 --verify");
  EXPECT_TRUE(says(plugin, "the load is the force on it at rest in its initial state"));
  EXPECT_TRUE(says(plugin, "5.34 for 5.34 rad/s"));
  EXPECT_TRUE(says(plugin, "100 %"));

  write_text(shell / "K.mtx",
             "%%MatrixMarket matrix coordinate real symmetric\n2 2 3\n1 1 30\n2 2 20\n2 1 -10\n");
  write_text(shell / "M.mtx", "%%MatrixMarket matrix array real general\n2 1\n1\n2\n");
  // 2 kappa^2 - 80 kappa + 500 = 0
  EXPECT_NEAR(
      shell.json("fidelity --matrices stiffness=K.mtx,mass=M.mtx --rate 30")["rows"][0]["modes"][0]["omega"]
          .get<double>(),
      std::sqrt(20 - std::sqrt(150.0)), 1e-9);
}

TEST(FidelityCommand, SaysWhatIsWrong) {
  const std::string body = "fidelity --mesh cube:n=2 ";
  expect_refusal(body + "--load press", "--rate");
  expect_refusal(body + "--load press --rate 0", "--rate must be a positive number");
  expect_refusal(body + "--load press --rate 60 --enter 5kP", "is no modulus");
  expect_refusal(body + "--load press --rate 60 --enter 1e308GPa", "is no modulus");
  expect_refusal(body + "--model mass_spring --set k=1000 --load press --rate 60 --ceiling", "leave k out");
  expect_refusal(body + "--load press --rate 60 --method vbd:iterations=0", "must be a whole number");
  expect_refusal(body + "--load press --rate 60 --method vbd:iteration=3", "did you mean 'iterations'?");
  expect_refusal(body + "--load press --rate 60 --method xpbd", "take one of the two");
  const std::string map = body + "--load press --rate 60 --map ";
  expect_refusal(map + "iterations", "--map is 'iterations', but there is one: iterations,substeps");
  expect_refusal(map + "iterations,substeps", "--map is of one method, and 0 are named");
  expect_refusal(map + "iterations,substeps --method vbd --method xpbd", "and 2 are named");
  expect_refusal(map + "iterations,substeps --method rk4", "rk4 has no numbers of iterations and substeps");
  expect_refusal(map + "iterations,substeps --method vbd:iterations=3", "--map chooses iterations itself");
  expect_refusal(map + "iterations,substeps --method xpbd:reset=1,substeps=2",
                 "--map chooses substeps itself");
  expect_refusal(body + "--load press --rate 60 --output map.svg", "--output draws the map; add --map");
  expect_refusal(map + "iterations,substeps --method vbd --output map.png",
                 "would not be what its name says");
  expect_refusal(body + "--load breathing --rate 60", "never settles");
  expect_refusal(body + "--load press --set force=0 --rate 60", "nothing loads the body");
  expect_refusal("fidelity --problem van_der_pol --rate 60", "van_der_pol has no positions and velocities");
  expect_refusal("fidelity --problem liver_forced --rate 60", "never settles");
  expect_refusal("fidelity --problem liver_linear --set k1=0 --rate 60",
                 "has no positive stiffness in its equilibrium");
  expect_refusal("fidelity --problem liver_linear --rate 60 --ceiling", "leave out --ceiling and --enter");
  expect_refusal("fidelity --problem liver_linear --rate 60 --method vbd", "take a mesh with --mesh");
}

}  // namespace
}  // namespace hmax
