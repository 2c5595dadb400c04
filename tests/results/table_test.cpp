#include "results/table.hpp"

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <limits>
#include <stdexcept>

#include <gtest/gtest.h>

#include "core/errors.hpp"
#include "core/numbers.hpp"
#include "core/part_file.hpp"
#include "tests/results/scratch.hpp"
#include "tests/says.hpp"

namespace hmax {
namespace {

std::string complaint(const std::string& text) {
  return error_of<InputError>([&] { parse_csv(text, "my.csv"); });
}

TEST(Numbers, ReadWhatPeopleAndProgramsWrite) {
  EXPECT_EQ(to_number(" 1.5\r"), 1.5);
  EXPECT_EQ(to_number("+2"), 2.0);
  EXPECT_EQ(to_number("1.0D+3"), 1000.0);
  EXPECT_EQ(to_number("-inf"), -std::numeric_limits<double>::infinity());
  EXPECT_TRUE(std::isnan(to_number("NaN").value()));
  for (const char* text : {"", " ", "1,5", "1.5x", "0x10", "1e999", "--1", "+-1", "+", "one", "1 2", "d"}) {
    EXPECT_FALSE(to_number(text)) << text;
  }
}

TEST(Numbers, AreWrittenWithTheFewestDigitsThatReadBack) {
  EXPECT_EQ(to_text(0.1), "0.1");
  EXPECT_EQ(to_text(0.00005), "5e-05");
  EXPECT_EQ(to_text(-0.0), "-0");
  EXPECT_EQ(to_text(-std::nan("")), "nan");
  EXPECT_EQ(rounded_text(2212.4, 3), "2210");
  EXPECT_EQ(rounded_text(999.6, 3), "1000");
  EXPECT_EQ(rounded_text(-49512, 3), "-49500");
  EXPECT_EQ(rounded_text(0.00012345, 3), "0.000123");
  EXPECT_EQ(rounded_text(1.5e7, 3), "1.5e+07");
  EXPECT_EQ(rounded_text(999'999'9.0, 3), "1e+07");
}

TEST(Table, ComesBackFromItsFileBitForBit) {
  Scratch scratch;
  const double tiny = std::numeric_limits<double>::denorm_min(),
               inf = std::numeric_limits<double>::infinity();
  Table table;
  table.notes = {{"problem", "liver: forced, x'' + x = 0"}, {"machine", ""}};
  table.columns = {"t [s]", "x, \"first\" [m]", "#3"};
  table.values = {
      {0, 0.1, 1.0 / 3, tiny}, {-0.0, inf, -inf, std::nan("")}, {1e308, -tiny, 12345678901234567.0, 5e-5}};
  write_csv(scratch / "deep/folder/a.csv", table);
  const Table back = read_csv(scratch / "deep/folder/a.csv");
  EXPECT_EQ(back.notes, table.notes);
  EXPECT_EQ(back.columns, table.columns);
  ASSERT_EQ(back.values.size(), 3u);
  for (std::size_t c = 0; c < 3; ++c) {
    ASSERT_EQ(back.values[c].size(), 4u);
    for (std::size_t r = 0; r < 4; ++r) {
      if (std::isnan(table.values[c][r])) {
        EXPECT_TRUE(std::isnan(back.values[c][r]));
      } else {
        EXPECT_EQ(std::bit_cast<std::uint64_t>(back.values[c][r]),
                  std::bit_cast<std::uint64_t>(table.values[c][r]));
      }
    }
  }
}

TEST(Table, AcceptsOtherProgramsLineEndsMarksAndMissingLastNewline) {
  const Table table = parse_csv(
      "\xEF\xBB\xBF# made by: a spreadsheet\r\n\r\n\"h [s]\",error\r\n 0.1 ,1.0D-3\r\n0.2,nan", "x");
  EXPECT_EQ(table.notes[0].second, "a spreadsheet");
  EXPECT_EQ(table.columns, (std::vector<std::string>{"h [s]", "error"}));
  EXPECT_EQ(table.values[0], (std::vector<double>{0.1, 0.2}));
  EXPECT_EQ(table.values[1][0], 1e-3);
  EXPECT_TRUE(parse_csv("a,b\n", "x").values[1].empty());
}

TEST(Table, NamesFileAndLineOfWhatItCannotRead) {
  EXPECT_EQ(complaint("a,b\n1,2\n1,5,2\n"),
            "my.csv:3: 3 cells where the header has 2: write decimals with a point, 1.5 and not 1,5.");
  EXPECT_TRUE(says(complaint("a,b\n\"1,5\",2\n"), "my.csv:2: '1,5' in column 'a'"));
  EXPECT_TRUE(says(complaint("a,b\n\n# note: x\n1\n"), "my.csv:4: 1 cells"));
  EXPECT_TRUE(says(complaint("a;b\n1;2\n"), "semicolons"));
  EXPECT_TRUE(says(complaint("a,b\n1;2\n"), "semicolons"));
  EXPECT_TRUE(says(complaint("a\n1e999\n"), "range"));
  EXPECT_TRUE(says(complaint(""), "no table"));
  EXPECT_TRUE(says(complaint("# only: notes\n"), "no table"));
}

TEST(Table, AFileThatCannotBeUsedIsAnInputErrorAndTheOldOneStays) {
  Scratch scratch;
  const Table table{.columns = {"a"}, .values = {{1}}};
  EXPECT_THROW(read_csv(scratch / "absent.csv"), InputError);
  EXPECT_THROW(read_csv(scratch.folder()), InputError);
  EXPECT_THROW(write_csv(scratch.folder(), table), InputError);
  EXPECT_THROW(write_csv("/dev/full", table), InputError);
  write_text(scratch / "file", "old");
  EXPECT_THROW(write_csv(scratch / "file/a.csv", table), InputError);
  EXPECT_THROW(write_csv(scratch / "file", Table{}), std::invalid_argument);
  EXPECT_EQ(read_text(scratch / "file"), "old");
  write_csv(scratch / "file", table);
  EXPECT_EQ(read_text(scratch / "file"), "# written by hmax\na\n1\n");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(scratch.folder()), {}), 1);
}

TEST(Table, WhatLeadsToAnOpenDescriptorIsWrittenBetweenWhatElseIsWrittenThere) {
  const Scratch scratch;
  const std::filesystem::path file = scratch / "printed", link = scratch / "link";
  // By its own descriptor, as /dev/stdout is, and as that of another process.
  for (const std::string place : {"/proc/self/fd/", "/proc/thread-self/fd/"}) {
    std::FILE* printed = std::fopen(file.c_str(), place == "/proc/self/fd/" ? "w" : "a");
    ASSERT_NE(printed, nullptr);
    std::filesystem::create_symlink(place + std::to_string(fileno(printed)), link);
    std::fputs("before ", printed);
    std::fflush(printed);
    check_writable(link);
    write_file(link, "points");
    std::fputs(" behind", printed);
    std::fclose(printed);
    EXPECT_TRUE(std::filesystem::is_symlink(link));
    EXPECT_TRUE(read_text(file).ends_with("before points behind")) << read_text(file);
    std::filesystem::remove(link);
  }
}

/// Before the run, not after it.
TEST(Table, ADescriptorThatTakesNothingIsRefusedAtOnce) {
  std::FILE* const read = std::fopen("/dev/null", "r");
  ASSERT_NE(read, nullptr);
  const std::string open = "/proc/self/fd/" + std::to_string(fileno(read));
  EXPECT_THROW(check_writable(open), InputError);
  std::fclose(read);
  EXPECT_THROW(check_writable(open), InputError);
}

TEST(PartFile, HasANameOfItsOwnAndLeavesNothing) {
  const Scratch scratch;
  const auto names = [&] {
    std::vector<std::string> all;
    for (const auto& entry : std::filesystem::directory_iterator(scratch.folder()))
      all.push_back(entry.path().filename().string());
    return all;
  };
  std::string first;
  {
    PartFile part(scratch / "x");
    part.write("half");
    ASSERT_EQ(names().size(), 1U);
    first = names()[0];
    EXPECT_TRUE(first.starts_with("x.") && first.ends_with(".part")) << first;
  }
  EXPECT_TRUE(names().empty());
  PartFile part(scratch / "x");
  EXPECT_NE(names().at(0), first);
  remove_part_file();  // as the handlers of signals do
  EXPECT_TRUE(names().empty());
}

TEST(PartFile, ReplacesWithTheRightsOfNewFiles) {
  const Scratch scratch;
  write_file(scratch / "x", "new");
  std::ofstream(scratch / "y") << "other";
  EXPECT_EQ(read_text(scratch / "x"), "new");
  EXPECT_EQ(std::filesystem::status(scratch / "x").permissions(),
            std::filesystem::status(scratch / "y").permissions());
}

}  // namespace
}  // namespace hmax
