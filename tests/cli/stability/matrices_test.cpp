/// Models of the user's own matrices, through the program.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/cli/program.hpp"

namespace hmax {
namespace {

using nlohmann::json;

void write(const Shell& shell, const std::string& name, const std::string& text) {
  std::ofstream(shell / name) << text;
}

/// A chain of three points.
void write_chain(const Shell& shell) {
  write(
      shell, "K.mtx",
      "%%MatrixMarket matrix coordinate real symmetric\n3 3 5\n1 1 200\n2 1 -100\n2 2 200\n3 2 -100\n3 3 100\n");
  write(shell, "M.mtx", "%%MatrixMarket matrix coordinate real general\n3 3 3\n1 1 1\n2 2 1\n3 3 0.5\n");
}
const std::string chain = "--matrices stiffness=K.mtx,mass=M.mtx";

json rows_of(const Shell& shell, const std::string& model, const std::string& methods) {
  return shell.json("stability predict " + model + " --methods " + methods).at("rows");
}

TEST(MatricesOfAUser, ExportedFromABodyTheyHaveItsLimits) {
  const Shell shell;
  for (const std::string body : {"--mesh phantom --material male_normal",
                                 "--mesh phantom --at rest --model mass_spring --set beta=1e-4"}) {
    const nlohmann::json told = shell.json("stability matrices --force --output out " + body);
    const std::string own = "--matrices " + told.at("matrices").get<std::string>();
    const json of_body = rows_of(shell, body, "rk4,symplectic_euler,newmark");
    const json of_files = rows_of(shell, own, "rk4,symplectic_euler,newmark");
    for (std::size_t i = 0; i < of_body.size(); ++i) {
      const json &x = of_body[i].at("h_max"), &y = of_files[i].at("h_max");
      EXPECT_EQ(of_files[i].at("state_kind"), "matrices");
      if (x.is_number())
        EXPECT_NEAR(y.get<double>() / x.get<double>(), 1, 1e-10) << x << " " << y;
      else
        EXPECT_EQ(x, y);
    }
  }
}

TEST(MatricesOfAUser, ExportedWithoutAnEquilibriumTheyAreThoseOfRestAndTheCodeSaysSo) {
  const Shell shell;
  for (const std::string free : {"stability matrices --mesh cube:n=2 --set support=0 --output out",
                                 "mesh convert cube:n=2 --gravity 0,0,-9.81 --matrices out"}) {
    SCOPED_TRACE(free);
    const Told told = shell.hmax(free + " --json --force");
    EXPECT_EQ(told.exit_code, 1);
    EXPECT_EQ(told.json().at("state_kind"), "rest");
    EXPECT_TRUE(told.json().at("status").is_string()) << told.out;
  }
  shell.text("stability matrices --mesh cube:n=2 --set support=0 --at rest --output out --json --force");
}

TEST(MatricesOfAUser, ExportedFromAMeshTheyHaveTheLimitsOfItsBody) {
  const Shell shell;
  // Every kind of element and of damping; free, and held.
  for (const std::string body : {"--model fem_corotational --set beta=1e-4",
                                 "--model fem_neo_hookean --set alpha=2 --support=-1,0.001,-1,1,-1,1",
                                 "--model mass_spring --set damper=0.1",
                                 "--model fem_green --gravity 0,0,-0.1 --support=-1,0.001,-1,1,-1,1"}) {
    SCOPED_TRACE(body);
    const nlohmann::json told = shell.json("mesh convert cube:n=2 --force --matrices out " + body);
    const std::string own = "--matrices " + told.at("matrices").get<std::string>();
    const std::string free =
        " --set g=0" + std::string(body.find("--support") == std::string::npos ? " --set support=0" : "");
    const bool loaded = body.find("--gravity") != std::string::npos;
    const std::string methods =
        "rk4,symplectic_euler,central_difference,linearly_implicit_euler,adams_bashforth_2";
    const json of_body = rows_of(shell, "--mesh cube:n=2 " + body + (loaded ? "" : free), methods);
    const json of_files = rows_of(shell, own, methods);
    for (std::size_t i = 0; i < of_body.size(); ++i) {
      const json &x = of_body[i].at("h_max"), &y = of_files[i].at("h_max");
      if (x.is_number())
        EXPECT_NEAR(y.get<double>(), x.get<double>(), 1e-10 * x.get<double>()) << of_body[i];
      else
        EXPECT_EQ(x, y) << of_body[i] << of_files[i];
    }
  }
  expect_refused(shell.hmax("mesh convert cube:n=2 a.vtu --matrices out"),
                 "are both given; remove one of them");
  expect_refused(shell.hmax("mesh convert cube:n=2"), "no output is given");
}

TEST(MatricesOfAUser, ThatChangeWithTimeHaveTheLeastLimitOfAllTimes) {
  const Shell shell;
  write_chain(shell);
  write(
      shell, "stiffer.mtx",
      "%%MatrixMarket matrix coordinate real symmetric\n3 3 5\n1 1 800\n2 1 -400\n2 2 800\n3 2 -400\n3 3 400\n");
  write(shell, "K.txt", "0 K.mtx\n1 stiffer.mtx\n2 K.mtx\n");
  const std::string series = "--matrices stiffness=series:K.txt,mass=M.mtx";
  const json still = rows_of(shell, chain, "rk4,symplectic_euler");
  const json rows = rows_of(shell, series + " --verify", "rk4,symplectic_euler");
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double start = rows[i].at("h_max").get<double>();
    EXPECT_NEAR(start / still[i].at("h_max").get<double>(), 1, 1e-12);
    EXPECT_LT(std::abs(rows[i].at("gap").get<double>()), 1e-3);
    // Four times the stiffness: half the step.
    EXPECT_NEAR(rows[i].at("along").at("h_min").get<double>() / start, 0.5, 1e-12);
    EXPECT_EQ(rows[i].at("along").at("t"), 1);
    // The changing model bears a longer step for a while, and not the one of its start.
    const double seen = rows[i].at("observed_from_start").get<double>();
    EXPECT_GT(seen, 0.5 * start);
    EXPECT_LT(seen, start);
  }
  const Told told = shell.hmax("stability predict --methods rk4 " + series);
  EXPECT_TRUE(says(told.out, "parametric resonance"));
  shell.text("run --json --method rk4 --h 0.01 --y0 1,0,0 " + series);
  EXPECT_EQ(shell.hmax("advise --json --rate 100 --frames 20 --methods rk4,newmark " + series).exit_code, 0);
}

TEST(MatricesOfAUser, ThatChangeWithTimeMayHaveACoupledMass) {
  const Shell shell;
  write_chain(shell);
  // Consistent masses of a bar.
  write(
      shell, "M.mtx",
      "%%MatrixMarket matrix coordinate real symmetric\n3 3 5\n1 1 0.6\n2 1 0.15\n2 2 0.6\n3 2 0.15\n3 3 0.3\n");
  write(
      shell, "stiffer.mtx",
      "%%MatrixMarket matrix coordinate real symmetric\n3 3 5\n1 1 800\n2 1 -400\n2 2 800\n3 2 -400\n3 3 400\n");
  write(shell, "K.txt", "0 K.mtx\n1 stiffer.mtx\n2 K.mtx\n");
  const json still = rows_of(shell, chain, "rk4,newmark");
  const json rows = rows_of(shell, "--matrices stiffness=series:K.txt,mass=M.mtx --verify", "rk4,newmark");
  const double start = rows[0].at("h_max").get<double>();
  EXPECT_NEAR(start / still[0].at("h_max").get<double>(), 1, 1e-12);
  EXPECT_LT(std::abs(rows[0].at("gap").get<double>()), 1e-3);
  EXPECT_NEAR(rows[0].at("along").at("h_min").get<double>() / start, 0.5, 1e-12);
  EXPECT_GT(rows[0].at("observed_from_start").get<double>(), 0.5 * start);
  EXPECT_LT(rows[0].at("observed_from_start").get<double>(), start);
  EXPECT_EQ(rows[1].at("h_max"), still[1].at("h_max"));
}

TEST(MatricesOfAUser, WithLagrangeMultipliersHaveLimitsThatRunsShow) {
  const Shell shell;
  write_chain(shell);
  // The second and the third point are tied: masses 1 and 1.5 on springs of 100 N/m to the wall and between
  // them.
  write(
      shell, "K.mtx",
      "%%MatrixMarket matrix coordinate real symmetric\n4 4 7\n1 1 200\n2 1 -100\n2 2 200\n3 2 -100\n3 3 100\n4 2 "
      "1\n4 3 -1\n");
  write(shell, "M.mtx", "%%MatrixMarket matrix array real general\n4 1\n1\n1\n0.5\n0\n");
  const json row = rows_of(shell, chain + " --verify", "symplectic_euler")[0];
  // kappa^2 - (200 + 100 / 1.5) kappa + (200 * 100 - 100^2) / 1.5 = 0.
  const double half = (200 + 100 / 1.5) / 2, kappa = half + std::sqrt(half * half - 1e4 / 1.5);
  EXPECT_NEAR(row.at("h_max").get<double>(), 2 / std::sqrt(kappa), 1e-12);
  EXPECT_LT(std::abs(row.at("gap").get<double>()), 1e-3);
}

TEST(MatricesOfAUser, OfFreeBodiesAreVerifiedBesideTheirRigidMotions) {
  const Shell shell;
  write_chain(shell);
  write(
      shell, "K.mtx",
      "%%MatrixMarket matrix coordinate real symmetric\n3 3 5\n1 1 100\n2 1 -100\n2 2 200\n3 2 -100\n3 3 100\n");
  for (const json& row : rows_of(shell, chain + " --verify", "rk4,symplectic_euler,newmark")) {
    EXPECT_EQ(row.at("agrees"), true) << row;
    if (!row.at("h_max").is_number()) continue;
    EXPECT_LT(std::abs(row.at("gap").get<double>()), 1e-3) << row;
  }
}

TEST(MatricesOfAUser, HaveLimitsThatRunsShow) {
  const Shell shell;
  write_chain(shell);
  for (const std::string damping : {"", " --alpha 0.2 --beta 1e-3"})
    for (const json& row :
         rows_of(shell, chain + damping + " --verify", "rk4,symplectic_euler,generalized_alpha")) {
      if (!row.at("h_max").is_number()) continue;
      EXPECT_LT(std::abs(row.at("gap").get<double>()), 1e-3) << row;
    }
}

TEST(MatricesOfAUser, AreRunByEveryKindOfMethod) {
  const Shell shell;
  write_chain(shell);
  for (const std::string method :
       {"rk4", "newmark", "explicit_newmark", "central_difference", "radau_iia_5", "rosenbrock_23"}) {
    shell.text("run " + chain + " --json --h 0.01 --y0 1,0,0 --t-end 0.5 --method " + method);
  }
  EXPECT_NEAR(shell.json("order " + chain + " --method rk4").at("observed").get<double>(), 4, 0.1);
}

TEST(MatricesOfAUser, OfFirstOrderHaveTheirLimit) {
  const Shell shell;
  write(shell, "J.mtx", "%%MatrixMarket matrix coordinate real general\n2 2 3\n1 1 -1\n1 2 1\n2 2 -50\n");
  const json rows = rows_of(shell, "--matrices jacobian=J.mtx --verify", "explicit_euler,rk4");
  EXPECT_NEAR(rows[0].at("h_max").get<double>(), 0.04, 1e-12);
  EXPECT_LT(std::abs(rows[0].at("gap").get<double>()), 1e-3);
}

TEST(MatricesOfAUser, PenaltyRowsAreNamedAndLeftOutWhenTold) {
  const Shell shell;
  write(
      shell, "K.mtx",
      "%%MatrixMarket matrix coordinate real symmetric\n4 4 7\n1 1 1e10\n2 1 -100\n2 2 200\n3 2 -100\n3 3 200\n4 3 "
      "-100\n4 4 100\n");
  write(shell, "M.mtx", "%%MatrixMarket matrix array real general\n4 1\n1\n1\n1\n1\n");
  const Told kept = shell.hmax("stability predict " + chain + " --methods rk4 --json");
  EXPECT_TRUE(says(kept.err, "the fastest mode, 100000 rad/s, is that of 1 penalty row (unknown 1)"));
  const Told left = shell.hmax("stability predict " + chain + ",drop=constraints --methods rk4 --json");
  EXPECT_EQ(left.err, "");
  EXPECT_GT(left.json().at("rows")[0].at("h_max").get<double>(),
            1000 * kept.json().at("rows")[0].at("h_max").get<double>());
  EXPECT_EQ(left.json().at("models")[0].at("matrices").at("penalty_rows"), json::array({1}));
}

TEST(MatricesOfAUser, HaveModesAndMaps) {
  const Shell shell;
  write_chain(shell);
  const double omega = shell.json("stability modes " + chain + " --fastest --count 1")
                           .at("modes")[0]
                           .at("omega")
                           .get<double>();
  EXPECT_NEAR(rows_of(shell, chain, "symplectic_euler")[0].at("h_max").get<double>() * omega, 2, 1e-9);
  const nlohmann::json map =
      shell.json("stability map " + chain + " --method rk4 --x alpha=0:2:3 --y beta=0:0.01:3");
  EXPECT_EQ(map.at("h_max").size(), 3U);
}

TEST(MatricesOfAUser, AreRunWithARemarkOnTheirStartAndTheirGrowth) {
  const Shell shell;
  write_chain(shell);
  const auto told = [&](const std::string& options) {
    return shell.hmax("run --method rk4 " + chain + options).err;
  };
  EXPECT_TRUE(
      says(told(" --h 0.01 --t-end 1"), "starts from pseudo-random displacements at rest of up to 0.001"));
  EXPECT_EQ(told(" --h 0.01 --t-end 1 --y0 1,0,0"), "");
  const std::string unstable = told(" --h 0.2 --t-end 8 --y0 1,0,0");
  EXPECT_TRUE(says(unstable, "times as large as it began"));
}

TEST(MatricesOfAUser, ThatLookSwappedAreTakenWithARemark) {
  const Shell shell;
  write_chain(shell);
  const auto told = [&](const std::string& matrices) {
    return shell.hmax("stability predict --methods newmark --matrices " + matrices).err;
  };
  EXPECT_TRUE(says(told("stiffness=M.mtx,mass=K.mtx"), "as if both were exchanged"));
  EXPECT_EQ(told("stiffness=K.mtx,mass=M.mtx"), "");
}

TEST(MatricesOfAUser, ThatNeedAFullMatrixTooLargeAreRefused) {
  const Shell shell;
  std::string K = "%%MatrixMarket matrix coordinate real general\n1600 1600 4798\n", M = K;
  for (int i = 1; i <= 1600; ++i)
    for (int j = std::max(1, i - 1); j <= std::min(1600, i + 1); ++j) {
      K += fmt::format("{} {} {}\n", i, j, i == j ? 200 : i < j ? -90 : -100);
      M += fmt::format("{} {} {}\n", i, j, i == j ? 0.6 : 0.15);
    }
  write(shell, "K.mtx", K);
  write(shell, "M.mtx", M);
  // The remark on symmetry may stand before the sentence.
  for (const auto& [command, part] :
       {std::pair("stability predict --methods rk4 ", "the mass couples 1600 unknowns"),
        {"run --method odeint_rosenbrock4 --h 1e-3 --t-end 0.01 ", "takes M^-1 K as one matrix"}}) {
    const Told told = shell.hmax(command + chain);
    EXPECT_EQ(told.exit_code, 2) << command;
    EXPECT_TRUE(says(told.err, part));
  }
}

TEST(MatricesOfAUser, AreRefusedWithASentence) {
  const Shell shell;
  write_chain(shell);
  const auto refused = [&](const std::string& options, const std::string& named) {
    expect_refused(shell.hmax("stability predict --methods rk4 " + options), named);
  };
  refused("--matrices stiffness=K.mtx", "--matrices has no mass");
  refused("--matrices K.mtx,M.mtx", "'K.mtx' of --matrices names no file");
  refused("--matrices stifness=K.mtx,mass=M.mtx", "unknown part 'stifness'");
  refused("--matrices stiffness=K.mtx,mass=lumped", "write mass=lumped:M.mtx");
  refused("--matrices stiffness=K.mtx,mass=M.mtx,mass=M.mtx", "names mass twice");
  refused("--matrices stiffness=K.mtx,mass=none.mtx", "there is no file 'none.mtx'");
  refused("--matrices jacobian=K.mtx,mass=M.mtx", "of a first-order model");
  refused("--matrices jacobian=K.mtx --alpha 1", "alpha belongs to second-order models");
  refused(chain + " --problem liver_forced", "--problem and --matrices are both given");
  refused(chain + " --mesh phantom", "--mesh and --matrices are both given");
  refused(chain + " --material male_normal", "--material belongs to bodies and oscillators");
  refused(chain + " --set gamma=1", "unknown parameter 'gamma' of matrices");
  refused(chain + ",drop=everything", "write drop=constraints");
}

}  // namespace
}  // namespace hmax
