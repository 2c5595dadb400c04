#include "catalogue/input/toml_file.hpp"

#include <array>
#include <cmath>
#include <filesystem>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "core/errors.hpp"
#include "tests/results/scratch.hpp"
#include "tests/says.hpp"

namespace hmax {
namespace {

using std::string_literals::operator""s;

/// The message of the InputError that reading `text` as case.toml throws; empty when it is accepted.
std::string complaint(std::string_view text) {
  return error_of<InputError>([&] { parse_toml(text, "case.toml"); });
}

TEST(TomlFile, GivesValuesInTheOrderOfTheFile) {
  const auto document = parse_toml("z = 1\na = [0.5, \"3/40\", true]\n[m]\nx = -2\nb.c = 1e3\n", "case.toml");
  EXPECT_EQ(document.root.dump(), R"({"z":1,"a":[0.5,"3/40",true],"m":{"x":-2,"b":{"c":1000.0}}})");
  EXPECT_TRUE(document.root["z"].is_number_integer());
}

TEST(TomlFile, KeepsInfinitiesAndNan) {
  const auto document = parse_toml("a = inf\nb = nan\nc = -inf", "case.toml");
  EXPECT_TRUE(std::isinf(document.root["a"].get<double>()));
  EXPECT_TRUE(std::isnan(document.root["b"].get<double>()));
  EXPECT_LT(document.root["c"].get<double>(), 0);
}

TEST(TomlFile, KnowsTheLineOfEveryPlace) {
  const auto document =
      parse_toml("\nz = 1\n\n[sweep]\n\"odd/key\" = 1\nsteps = [\n  0.1,\n  0.2]\n[[run]]\n[[run]]\nh = 2\n",
                 "case.toml");
  EXPECT_EQ(document.line("/z"), 2);
  EXPECT_EQ(document.line("/sweep"), 4);
  EXPECT_EQ(document.line("/sweep/odd~1key"), 5);
  EXPECT_EQ(document.line("/sweep/steps/1"), 8);
  EXPECT_EQ(document.line("/sweep/steps/7/x"), 6) << "the nearest place around an unknown one";
  EXPECT_EQ(document.line("/run/1/h"), 11);
  EXPECT_EQ(document.line(""), 0);
  EXPECT_EQ(document.line("/nowhere"), 0);
}

TEST(TomlFile, AcceptsWindowsLineEndsByteOrderMarkAndMissingLastNewline) {
  EXPECT_EQ(parse_toml("\xEF\xBB\xBF"
                       "a = 1\r\nb = 2",
                       "case.toml")
                .root.dump(),
            R"({"a":1,"b":2})");
  EXPECT_EQ(parse_toml("", "case.toml").root.dump(), "{}");
  EXPECT_EQ(parse_toml("# \xC3\xBC only a comment", "case.toml").root.dump(), "{}");
}

TEST(TomlFile, NamesFileAndLineOfASyntaxError) {
  EXPECT_EQ(complaint("a = 1\nb = \n").substr(0, 12), "case.toml:2:");
  EXPECT_EQ(complaint("a = 1\na = 2\n").substr(0, 12), "case.toml:2:");
}

TEST(TomlFile, ComplainsInOneLineOfNamesAndWordsWithLineBreaks) {
  EXPECT_TRUE(says(complaint("a = fals\n"), "expected 'false', saw 'fals?'"));
  const auto document = parse_toml("\"a\\nb\" = 1", "case.toml");
  constexpr std::array<std::string_view, 1> allowed{"step"};
  EXPECT_EQ(error_of<InputError>([&] { reject_unknown_keys(document, "", allowed); }),
            "case.toml:1: unknown key 'a?b'; known are step");
}

TEST(TomlFile, HintsAtADecimalComma) {
  EXPECT_TRUE(says(complaint("a = 1\nh = 1,5\n"), "write 1.5 with a decimal point"));
  EXPECT_FALSE(says(complaint("a = 1\nh = = 2\n"), "decimal point"));
}

TEST(TomlFile, RefusesWhatBreaksItsParser) {
  for (const std::string& text : {"["s, "[\n"s, "[[\n"s, "[ \n]"s, "[="s, "a.\n"s, "a = [\n"s,
                                  "\xEF\xBB\x9F"s, "\xEF\xBB\x9F = 1"s, "a\xEF\xBB\x9F = 1"s}) {
    EXPECT_EQ(complaint(text).substr(0, 9), "case.toml") << text;
  }
}

TEST(TomlFile, KeepsEveryLetterWithinStringsAndKeys) {
  const auto document =
      parse_toml("'é~' = \"\"\"\\\n  −~7e\"\"\" # ü\nb = ['“', \"\\u00e9~c3\"]", "case.toml");
  EXPECT_EQ(document.root.dump(), "{\"é~\":\"−~7e\",\"b\":[\"“\",\"é~c3\"]}");
  EXPECT_EQ(document.line("/é~0"), 1);
}

TEST(TomlFile, RefusesWhatIsNotAsciiElsewhere) {
  for (const std::string& text : {"a = 1\nb = −1"s, "a = 1\né = 1"s, "a = 1\nb = “x”"s}) {
    const std::string message = complaint(text);
    EXPECT_TRUE(message.starts_with("case.toml:2:")) << message;
    EXPECT_TRUE(says(message, "only in quotes and in comments"));
  }
  EXPECT_TRUE(complaint("a = 1\nb = ~1").starts_with("case.toml:2:"));
}

TEST(TomlFile, RefusesBytesThatAreNotText) {
  EXPECT_TRUE(says(complaint("a = \"\xFF\""), "UTF-8"));
  EXPECT_TRUE(says(complaint("a = 1\nb\0 = 2"s), "case.toml:2: control byte 0x00"));
  EXPECT_TRUE(says(complaint("# \x1b[31m"), "control byte 0x1b"));
}

TEST(TomlFile, RefusesHostileSizes) {
  EXPECT_TRUE(says(complaint(std::string(2 << 20, '\n')), "1 MiB"));
  std::string deep;
  for (int i = 0; i < 200000; ++i) deep += "a.";
  EXPECT_TRUE(says(complaint(deep + "a = 1"), "line is longer"));
  EXPECT_NE(complaint("a = " + std::string(2000, '[') + std::string(2000, ']')), "");
  std::string as_deep_as_lines_allow;
  for (int i = 0; i < 2000; ++i) as_deep_as_lines_allow += "a.";
  EXPECT_EQ(complaint(as_deep_as_lines_allow + "a = 1"), "");
}

TEST(TomlFile, RefusesDates) { EXPECT_TRUE(says(complaint("a = 1\nb = 2020-01-01"), "case.toml:2: a date")); }

TEST(TomlFile, SurvivesRandomDamage) {
  const std::string sound =
      "name = \"rk\" # c\na = [[], [0.5], [\"1/2\", 3]]\n[t.u]\nx = {y = 1, z = 'q'}\n[[v]]\nw = -1e3\n";
  const std::vector<std::string> pieces{"[", "]", "\n",           "=",        "\"",  "'",  "{", "}",     ".",
                                        ",", "#", "\xEF\xBB\x9F", "\xC3\xA9", "\\u", "0x", "_", "\"\"\""};
  std::mt19937 random(20);
  for (int round = 0; round < 3000; ++round) {
    std::string text = sound;
    for (int damage = 0; damage < 3; ++damage) {
      const std::size_t at = random() % text.size();
      if (random() % 3 == 0) {
        text.erase(at, 1 + random() % 4);
      } else {
        text.insert(at, pieces[random() % pieces.size()]);
      }
    }
    const std::string message = complaint(text);
    EXPECT_TRUE(message.empty() || message.starts_with("case.toml")) << text;
  }
}

TEST(TomlFile, ComplainsAboutAFileThatIsNotThereOrIsAFolder) {
  const auto message = [](const std::filesystem::path& path) -> std::string {
    return error_of<InputError>([&] { read_toml(path); });
  };
  EXPECT_EQ(message("nowhere.toml"), "nowhere.toml: no such file; check the path");
  EXPECT_TRUE(says(message(std::filesystem::temp_directory_path()), "this is a folder"));
  EXPECT_TRUE(says(message("/dev/zero"), "larger than 1 MiB"));
}

TEST(TomlFile, ReadsAFileFromDisk) {
  const Scratch scratch;
  write_text(scratch / "a.toml", "a = 1\n");
  EXPECT_EQ(read_toml(scratch / "a.toml").root["a"], 1);
}

TEST(RejectUnknownKeys, NamesLineTableAndTheNearestKey) {
  const auto document = parse_toml("a = 1\n[sweep]\nstpe = 1\n", "case.toml");
  constexpr std::array<std::string_view, 2> allowed{"step", "methods"}, top{"a", "sweep"};
  EXPECT_NO_THROW(reject_unknown_keys(document, "", top));
  EXPECT_NO_THROW(reject_unknown_keys(document, "/absent", top));
  EXPECT_EQ(error_of<InputError>([&] { reject_unknown_keys(document, "/sweep", allowed); }),
            "case.toml:3: unknown key 'stpe' in [sweep]; did you mean 'step'?");
  EXPECT_EQ(error_of<InputError>([&] { reject_unknown_keys(document, "", allowed); }),
            "case.toml:1: unknown key 'a'; known are step, methods");
  EXPECT_THROW(reject_unknown_keys(document, "/a", allowed), InputError) << "a number is not a table";
}

}  // namespace
}  // namespace hmax
