#include "tests/cli/program.hpp"

namespace hmax {
namespace {

TEST(Mpirun, CopiesThatWouldWriteToOneStoreAreRefused) {
  const Shell shell;
  ASSERT_EQ(shell.hmax("sweep --methods rk4 --h 0.1 --fixed --t-end 1 --out one").exit_code, 0);
  for (const char* variable : {"OMPI_COMM_WORLD_SIZE=2", "PMI_SIZE=2"})
    for (const std::string& command :
         {std::string("precision --methods rk4 --h 0.1 --t-end 1 --store two.sqlite"),
          std::string("merge two one"), std::string("advise --problem liver_forced --rate 100 --out two"),
          std::string("stability predict --problem liver_linear --methods rk4 --out two"),
          std::string("reproduce all --quick --output two"),
          std::string("reproduce oscillators --output two"), std::string("reproduce stability --output two"),
          std::string("reproduce tissue --quick --output two")}) {
      expect_refused(shell.line(std::string("export ") + variable + " && hmax " + command),
                     "mpirun started 2 copies");
      EXPECT_FALSE(std::filesystem::exists(shell / "two")) << command;
      EXPECT_FALSE(std::filesystem::exists(shell / "results/runs/two.sqlite")) << command;
    }
}

TEST(Mpirun, ProcessesWithShardsOrWithoutAStoreAreNotRefused) {
  const Shell shell;
  for (const char* command : {"sweep --methods rk4 --h 0.1 --fixed --t-end 1 --shard 1/2 --out part",
                              "list methods", "precision --methods rk4 --h 0.1 --t-end 1",
                              "stability predict --problem liver_linear --methods rk4"})
    EXPECT_EQ(shell.line(std::string("export OMPI_COMM_WORLD_SIZE=2 && hmax ") + command).exit_code, 0)
        << command;
  // Not of several processes, and no number.
  for (const char* size : {"1", "", "two"})
    EXPECT_EQ(
        shell.line(std::string("export PMI_SIZE=") + size + " && hmax merge all results/runs/part.sqlite")
            .exit_code,
        0)
        << size;
}

TEST(Mpirun, AnErrorOfAllIsToldByRank0) {
  const auto told = [](const char* rank) {
    return Shell().line(std::string("export OMPI_COMM_WORLD_SIZE=2 OMPI_COMM_WORLD_RANK=") + rank +
                        "; timeout 0.5 '" HMAX_PROGRAM "' list nothing");
  };
  expect_refused(told("0"), "nothing");
  // Seconds later, when mpirun has ended it.
  EXPECT_EQ(told("1").exit_code, 124);
  EXPECT_EQ(told("1").err, "");
  expect_refused(Shell().line("OMPI_COMM_WORLD_SIZE=2 OMPI_COMM_WORLD_RANK=1 hmax list nothing"), "nothing");
}

}  // namespace
}  // namespace hmax
