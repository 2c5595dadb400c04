/// hmax stability predict --engine petsc, on one process and on two.
#include <bit>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <functional>
#include <numbers>

#include <fmt/format.h>

#include "tests/cli/mpirun.hpp"

namespace hmax {
namespace {

using nlohmann::json;

constexpr int nodes = 59;
constexpr double spacing = 1.0 / (nodes + 1);

/// Entries of a matrix with the same three numbers in every row.
using Entry = std::function<double(int row, int column)>;
Entry tridiagonal(double diagonal, double beside) {
  return [=](int i, int j) { return i == j ? diagonal : std::abs(i - j) == 1 ? beside : 0; };
}

/// A bar of 60 linear elements, held at both ends, of unit stiffness and density.
const Entry stiffness = tridiagonal(2 / spacing, -1 / spacing);
const Entry consistent = tridiagonal(4 * spacing / 6, spacing / 6);
const Entry lumped = tridiagonal(spacing, 0);
Entry combined(double a, const Entry& A, double b, const Entry& B) {
  return [=](int i, int j) { return a * A(i, j) + b * B(i, j); };
}

/// Its fastest mode: kappa of sin(i theta), by hand.
double fastest_omega(bool with_consistent) {
  const double c = std::cos(nodes * std::numbers::pi / (nodes + 1));
  return std::sqrt((with_consistent ? 6 * (1 - c) / (2 + c) : 2 * (1 - c))) / spacing;
}

void write_market(const std::filesystem::path& file, const Entry& entry, int rows = nodes) {
  std::string text;
  int count = 0;
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < rows; ++j)
      if (const double value = entry(i, j); value != 0) {
        text += fmt::format("{} {} {:.17g}\n", i + 1, j + 1, value);
        ++count;
      }
  std::ofstream(file) << "%%MatrixMarket matrix coordinate real general\n"
                      << fmt::format("{} {} {}\n", rows, rows, count) << text;
}

template <class T>
void put(std::string& bytes, T value) {
  const auto bits = std::bit_cast<std::conditional_t<sizeof(T) == 8, std::uint64_t, std::uint32_t>>(value);
  for (int shift = 8 * (static_cast<int>(sizeof(T)) - 1); shift >= 0; shift -= 8)
    bytes += static_cast<char>(bits >> shift);
}

void write_petsc(const std::filesystem::path& file, const Entry& entry) {
  std::string lengths, columns, values;
  std::int32_t count = 0;
  for (int i = 0; i < nodes; ++i) {
    const std::int32_t before = count;
    for (int j = 0; j < nodes; ++j)
      if (const double value = entry(i, j); value != 0) {
        put<std::int32_t>(columns, j);
        put(values, value);
        ++count;
      }
    put(lengths, count - before);
  }
  std::string head;
  for (const std::int32_t number : {1211216, nodes, nodes, count}) put(head, number);
  std::ofstream(file, std::ios::binary) << head << lengths << columns << values;
}

/// A shell with the matrices of the bar in its folder, in both formats.
class Distributed : public testing::Test {
 protected:
  void SetUp() override {
    if (!is_built_with("SLEPc"))
      GTEST_SKIP() << "this build has no engine petsc: petsc-dev or slepc-dev was missing";
    const auto write = [&](const std::string& name, const Entry& entry) {
      write_market(shell / (name + ".mtx"), entry);
      write_petsc(shell / (name + ".bin"), entry);
    };
    write("K", stiffness);
    write("M", consistent);
    write("L", lumped);
    write("R", combined(0.3, lumped, 1e-3, stiffness));
    write("other", [](int i, int j) { return i == j ? 1.0 + i : 0; });
    write("skewed", [](int i, int j) { return i == j ? 2.0 : j == i + 1 ? -1.0 : j == i - 1 ? -0.5 : 0.0; });
    write("massless", [](int i, int j) { return i != j ? 0.0 : i == 6 ? -1.0 : 1.0; });
    for (const auto& [name, strength] : {std::pair{"weak", 0.05}, {"strong", 30.0}})
      write(name, [strength](int i, int j) { return i == j && i % 7 == 3 ? strength * spacing / 6 : 0; });
    write("exciting", [](int i, int j) { return i != j ? 0 : i == 6 ? -1.0 : 1.0 + i; });
    write("buckled", combined(1, stiffness, -100, lumped));
    write("negative", combined(-1, stiffness, 0, lumped));
    write("released", [](int i, int j) { return i == 6 || j == 6 ? 0 : stiffness(i, j); });
  }

  /// `--engine petsc` on so many processes.
  [[nodiscard]] Told petsc(int ranks, const std::string& rest) const {
    const std::string command = "stability predict --engine petsc " + rest;
    return shell.line(with_mpi + (ranks == 1 ? "hmax " : "timeout 180 " + mpirun_two + HMAX_PROGRAM " ") +
                      command);
  }

  void expect_as_built_in(int ranks, const std::string& rest) const {
    const Told own = shell.hmax("stability predict " + rest + " --json"),
               told = petsc(ranks, rest + " --json");
    ASSERT_EQ(told.exit_code, 0) << told.err;
    const json expected = own.json().at("rows"), rows = told.json().at("rows");
    ASSERT_EQ(rows.size(), expected.size());
    for (std::size_t i = 0; i < rows.size(); ++i) {
      EXPECT_EQ(rows[i].at("method"), expected[i].at("method"));
      // Matrices know nothing of the largest step that Newton's method solves on a body.
      if (expected[i].at("bound") != "newton") {
        EXPECT_EQ(rows[i].at("bound"), expected[i].at("bound")) << rows[i];
      }
      const json &h = rows[i].at("h_max"), &h_expected = expected[i].at("h_max");
      if (!h_expected.is_number()) {
        EXPECT_EQ(h, h_expected) << rows[i];
        continue;
      }
      EXPECT_NEAR(h.get<double>(), h_expected.get<double>(), 1e-10 * h_expected.get<double>())
          << rest << rows[i].at("method");
    }
    EXPECT_EQ(told.json().at("models").at(0).at("ranks"), ranks);
  }

  void expect_all_as_built_in(int ranks) const {
    const std::string methods =
        "--methods rk4,symplectic_euler,newmark,rkc_2,explicit_newmark --matrices stiffness=";
    for (const char* rest : {"K.bin,mass=L.bin,damping=R.bin", "K.bin,mass=M.bin --alpha 2 --beta 0.001",
                             "K.mtx,mass=M.mtx", "K.mtx,mass=lumped:M.mtx"})
      expect_as_built_in(ranks, methods + rest);
  }

  /// Where damping couples the modes: limits of all modes, or between a bound and what is unstable.
  void expect_damped_as_built_in(int ranks) const {
    for (const char* matrices :
         {"K.bin,mass=L.bin,damping=weak.bin", "K.mtx,mass=M.mtx,damping=strong.mtx --alpha 1 --beta 1e-4"}) {
      const std::string rest =
          std::string("--json --methods rk4,symplectic_euler,newmark --matrices stiffness=") + matrices;
      const Told own = shell.hmax("stability predict " + rest), told = petsc(ranks, rest);
      ASSERT_EQ(told.exit_code, 0) << told.err;
      EXPECT_EQ(told.json().at("models").at(0).at("damping"), "general");
      for (std::size_t i = 0; i < 3; ++i) {
        const json row = told.json().at("rows").at(i), all = own.json().at("rows").at(i);
        EXPECT_EQ(row.at("bound"), all.at("bound")) << row;
        if (!all.at("h_max").is_number()) continue;
        const double h = row.at("h_max"), expected = all.at("h_max");
        if (row.at("h_unstable").is_null()) {
          EXPECT_NEAR(h, expected, 1e-10 * expected) << matrices << row;
        } else {
          EXPECT_LE(h, expected * (1 + 1e-10)) << matrices << row;
          if (row.at("h_unstable").is_number()) {
            EXPECT_GE(row.at("h_unstable").get<double>(), expected * (1 - 1e-10)) << matrices << row;
          }
        }
      }
    }
  }

  void expect_confirmed(int ranks, const std::string& rest) const {
    const Told told = petsc(ranks, rest + " --verify --json");
    EXPECT_EQ(told.exit_code, 0) << rest << told.err;
    const json document = told.json();
    std::size_t confirmed = 0;
    for (const json& row : document.at("rows")) {
      if (row.at("bound") == "every_step") continue;
      ++confirmed;
      EXPECT_EQ(row.at("agrees"), true) << rest << row;
      if (row.at("h_max").is_number()) {
        EXPECT_NEAR(row.at("gap").get<double>(), 0, 1e-3) << rest << row;
      }
    }
    EXPECT_GE(confirmed, 1U) << rest;
  }

  void expect_all_confirmed(int ranks) const {
    const std::string methods =
        "--methods rk4,rk2_heun,symplectic_euler,velocity_verlet,adams_bashforth_3,explicit_newmark,newmark:beta=0.1,newmark,"
        "implicit_euler,trapezoidal,linearly_implicit_euler";
    for (const char* rest : {",central_difference --alpha 2 --matrices stiffness=K.bin,mass=L.bin",
                             " --alpha 2 --beta 0.02 --matrices stiffness=K.mtx,mass=lumped:M.mtx",
                             ",central_difference --matrices stiffness=K.mtx,mass=M.mtx",
                             ",rkc_2 --beta 0.001 --matrices stiffness=K.bin,mass=M.bin"})
      expect_confirmed(ranks, methods + rest);
  }

  Shell shell;
};

TEST_F(Distributed, FastestModeOfABarIsThatOfTheClosedForm) {
  for (const bool is_consistent : {false, true}) {
    const Told told = petsc(1, fmt::format("--methods rk4 --matrices stiffness=K.bin,mass={}.bin --json",
                                           is_consistent ? "M" : "L"));
    ASSERT_EQ(told.exit_code, 0) << told.err;
    const double omega = fastest_omega(is_consistent);
    EXPECT_NEAR(std::sqrt(told.json().at("models").at(0).at("kappa_max").get<double>()) / omega, 1, 1e-10);
    EXPECT_NEAR(told.json().at("rows").at(0).at("h_max").get<double>() * omega / std::sqrt(8.0), 1, 1e-10);
  }
}

TEST_F(Distributed, OneProcessAgreesWithTheBuiltInEngine) { expect_all_as_built_in(1); }

TEST_F(Distributed, TwoProcessesAgreeWithTheBuiltInEngine) {
  if (!starts_two_processes()) GTEST_SKIP() << "mpirun starts no two processes here";
  expect_all_as_built_in(2);
}

TEST_F(Distributed, DampingThatCouplesTheModesOnOneProcess) { expect_damped_as_built_in(1); }

TEST_F(Distributed, DampingThatCouplesTheModesOnTwoProcesses) {
  if (!starts_two_processes()) GTEST_SKIP() << "mpirun starts no two processes here";
  expect_damped_as_built_in(2);
}

TEST_F(Distributed, RunsConfirmLimitsOnOneProcess) { expect_all_confirmed(1); }

TEST_F(Distributed, RunsConfirmLimitsOnTwoProcesses) {
  if (!starts_two_processes()) GTEST_SKIP() << "mpirun starts no two processes here";
  expect_all_confirmed(2);
}

TEST_F(Distributed, RowsThatAreNotVerifiedSayWhy) {
  const Told told =
      petsc(1, "--methods rk4,radau_iia_5 --matrices stiffness=K.bin,mass=L.bin --verify --json");
  ASSERT_EQ(told.exit_code, 0) << told.err;
  const json rows = told.json().at("rows");
  EXPECT_EQ(rows.at(0).at("agrees"), true);
  EXPECT_TRUE(rows.at(1).at("agrees").is_null());
  EXPECT_NE(rows.at(1).at("status").get<std::string>().find("its equations are no real numbers"),
            std::string::npos);
}

TEST_F(Distributed, MassesMayBeAColumn) {
  std::string column = fmt::format("%%MatrixMarket matrix array real general\n{} 1\n", nodes);
  for (int i = 0; i < nodes; ++i) column += fmt::format("{:.17g}\n", lumped(i, i));
  std::ofstream(shell / "column.mtx") << column;
  expect_as_built_in(1, "--methods rk4 --matrices stiffness=K.mtx,mass=column.mtx");
  expect_refused(petsc(1, "--methods rk4 --matrices stiffness=column.mtx,mass=column.mtx"),
                 "a matrix of a structure is square");
}

TEST_F(Distributed, DampingOfAFileIsTakenApart) {
  const json model = petsc(1, "--methods rk4 --matrices stiffness=K.bin,mass=L.bin,damping=R.bin --json")
                         .json()
                         .at("models")
                         .at(0);
  EXPECT_NEAR(model.at("alpha").get<double>(), 0.3, 1e-9);
  EXPECT_NEAR(model.at("beta").get<double>(), 1e-3, 1e-12);
}

TEST_F(Distributed, NegativeStiffnessIsSeen) {
  const json row =
      petsc(1, "--methods rk4 --matrices stiffness=buckled.bin,mass=L.bin --json").json().at("rows").at(0);
  EXPECT_EQ(row.at("bound"), "stability") << "of the modes that do not grow";
  EXPECT_NE(row.at("status").get<std::string>().find("the model itself grows"), std::string::npos) << row;
}

TEST_F(Distributed, NegativeStiffnessAloneGrowsAtItsRate) {
  const Told told = petsc(1, "--methods rk4 --matrices stiffness=negative.bin,mass=L.bin --json");
  EXPECT_EQ(told.exit_code, 1) << "no step is stable, as without --engine";
  const json row = told.json().at("rows").at(0);
  EXPECT_EQ(row.at("bound"), "model");
  EXPECT_NEAR(row.at("limiting").at("re").get<double>() / fastest_omega(false), 1, 1e-6) << row;
}

TEST_F(Distributed, RowsOfStiffnessMayHaveNoDiagonalEntry) {
  expect_as_built_in(1, "--methods rk4 --matrices stiffness=released.bin,mass=M.bin");
}

TEST_F(Distributed, WarnsOfStiffnessAndMassThatLookExchanged) {
  const Told told = petsc(1, "--methods rk4 --matrices stiffness=M.bin,mass=K.bin");
  EXPECT_EQ(told.exit_code, 0);
  EXPECT_NE(told.err.find("as if both were exchanged"), std::string::npos) << told.err;
}

TEST_F(Distributed, BodiesAtRestHaveTheLimitsOfTheBuiltInEngine) {
  const std::string methods = "--at rest --methods rk4,symplectic_euler,newmark ";
  for (
      const char* body :
      {"--mesh phantom --material liver:male_normal --beta 0.01 --set skin=50",
       "--mesh ball:n=4 --model mass_spring --set damper=0.02 --set skin=100 --set equal_masses=1 --load press",
       "--mesh ball:n=4 --model fem_neo_hookean --set support=0 --set mass_step=0.001 --set skin=100"})
    expect_as_built_in(1, methods + body);
}

TEST_F(Distributed, BodiesAtRestOnTwoProcesses) {
  if (!starts_two_processes()) GTEST_SKIP() << "mpirun starts no two processes here";
  expect_as_built_in(
      2, "--at rest --methods rk4,symplectic_euler --mesh phantom --material liver:male_normal --beta 0.01");
  expect_confirmed(2, "--at rest --methods rk4,newmark,newmark:beta=0.1 --mesh phantom --alpha 2");
}

TEST_F(Distributed, RefusesWhatItCannotTakeInOneSentence) {
  std::ofstream(shell / "cut.bin", std::ios::binary) << read_text(shell / "K.bin").substr(0, 700);
  for (const auto& [rest, named] : std::initializer_list<std::pair<const char*, const char*>>{
           {"--matrices stiffness=skewed.bin,mass=L.bin", "skewed.bin is not symmetric"},
           {"--matrices stiffness=skewed.mtx,mass=L.mtx", "skewed.mtx is not symmetric"},
           {"--matrices stiffness=K.bin,mass=massless.bin", "the mass of row 7 is not positive"},
           {"--matrices stiffness=K.bin,mass=L.bin,damping=exciting.bin", "has a negative eigenvalue"},
           {"--matrices stiffness=K.bin,mass=L.bin,damping=skewed.bin", "skewed.bin is not symmetric"},
           {"--matrices stiffness=cut.bin,mass=L.bin", "cut.bin cannot be read: PETSc says"},
           {"--matrices stiffness=none.mtx,mass=L.bin", "none.mtx"},
           {"--matrices jacobian=K.bin", "a jacobian"},
           {"--matrices stiffness=K.bin,mass=L.bin --out here", "--out"},
           {"--matrices stiffness=K.bin,mass=L.bin --set m=2", "unknown parameter 'm'"},
           {"--matrices stiffness=K.bin,mass=L.bin --jobs 2", "mpirun -n N"},
           {"--mesh phantom", "add --at rest"},
           {"--mesh phantom --at equilibrium", "write --at rest"},
           {"--mesh phantom --at rest --load tool", "--load tool"},
           {"--mesh phantom --at rest --materials liver:male_normal", "--materials"},
           {"--mesh phantom --at rest --model mass_spring --set bending=1", "relative to the mean"},
           {"--mesh none --at rest", "there is no mesh"},
           {"--problem kepler", "--matrices and --mesh alone"}})
    expect_refused(petsc(1, fmt::format("--methods rk4 {}", rest)), named);
  expect_refused(petsc(1, "--methods none --matrices stiffness=K.bin,mass=L.bin"), "unknown method 'none'");
}

TEST_F(Distributed, TwoProcessesTellAnErrorOnce) {
  if (!starts_two_processes()) GTEST_SKIP() << "mpirun starts no two processes here";
  for (const char* files : {"stiffness=skewed.bin,mass=L.bin", "stiffness=none.mtx,mass=L.mtx",
                            "stiffness=K.bin,mass=L.bin --out here"}) {
    const Told told = petsc(2, fmt::format("--methods rk4 --matrices {}", files));
    EXPECT_EQ(told.exit_code, 2);
    EXPECT_EQ(told.out, "");
    const std::size_t first = told.err.find("hmax: ");
    EXPECT_NE(first, std::string::npos);
    EXPECT_EQ(told.err.find("hmax: ", first + 1), std::string::npos) << told.err;
  }
}

TEST_F(Distributed, ScenesAreJudgedAsByTheBuiltInEngine) {
  ASSERT_EQ(shell.hmax("mesh convert ball:n=2 ball.scn --h 0.01 --support 'z<0.02'").exit_code, 0);
  std::string text = read_text(shell / "ball.scn");
  text.replace(text.find("EulerImplicitSolver"), 19, "EulerExplicitSolver");
  for (const char* damping : {" rayleighMass=\"0\"", " rayleighStiffness=\"0\""})
    text.erase(text.find(damping), std::string_view(damping).size());
  text.replace(text.find("<EulerExplicitSolver"), 0, "<CollisionPipeline/>");
  write_text(shell / "ball.scn", text);
  const std::string rest = "--at rest --scene ball.scn --unit m,kg,s --ignore CollisionPipeline";
  const Told own = shell.hmax("stability predict " + rest + " --json"), told = petsc(1, rest + " --json");
  ASSERT_EQ(told.exit_code, 0) << told.err;
  EXPECT_TRUE(says(told.err, "left out of ball.scn: CollisionPipeline"));
  const json expected = own.json().at("scene"), scene = told.json().at("scene");
  EXPECT_EQ(scene.at("within"), false);
  EXPECT_EQ(scene.at("method"), expected.at("method"));
  EXPECT_NEAR(scene.at("h_max"), expected.at("h_max"), 1e-9 * expected.at("h_max").get<double>());
  EXPECT_TRUE(says(petsc(1, rest).out, "(symplectic_euler) is unstable: at most"));
  EXPECT_EQ(petsc(1, rest + " --methods rk4 --json").json().count("scene"), 0U);
}

TEST(DistributedEngine, UnknownNamesAreRefused) {
  expect_refused(
      Shell().hmax("stability predict --engine slepc --methods rk4 --matrices stiffness=K.mtx,mass=M.mtx"),
      "'slepc'");
}

TEST(DistributedEngine, ABuildWithoutItSaysSo) {
  if (is_built_with("SLEPc")) GTEST_SKIP() << "this build has the engine";
  expect_refused(
      Shell().hmax("stability predict --engine petsc --methods rk4 --matrices stiffness=K.mtx,mass=M.mtx"),
      "built without");
}

}  // namespace
}  // namespace hmax
