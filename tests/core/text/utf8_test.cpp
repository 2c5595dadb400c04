#include "core/text/utf8.hpp"

#include <gtest/gtest.h>

namespace hmax {
namespace {

// Table 3-7 of the Unicode standard: well-formed byte sequences, at both ends of each of its rows.
TEST(Utf8, KnowsWellFormedSequences) {
  for (const char* character :
       {"a", "\x7f", "\xC2\x80", "\xDF\xBF", "\xE0\xA0\x80", "\xEC\xBF\xBF", "\xED\x9F\xBF", "\xEE\x80\x80",
        "\xF0\x90\x80\x80", "\xF3\xBF\xBF\xBF", "\xF4\x8F\xBF\xBF"})
    EXPECT_EQ(utf8_character(character), std::string_view(character).size()) << character;
  for (const char* other :
       {"\x80", "\xBF", "\xC0\x80", "\xC1\xBF", "\xC2", "\xC2\x41", "\xE0\x9F\xBF", "\xE2\x82",
        "\xED\xA0\x80", "\xF0\x8F\xBF\xBF", "\xF4\x90\x80\x80", "\xF5\x80\x80\x80", "\xFF"})
    EXPECT_EQ(utf8_character(other), 0U) << other;
}

TEST(Utf8, ShowsBytesThatAreNoCharacters) {
  EXPECT_EQ(as_utf8("w\xC3\xBCrfel.msh"), "w\xC3\xBCrfel.msh");
  EXPECT_EQ(as_utf8("w\xFCrfel.msh"), "w\\xFCrfel.msh");
  EXPECT_EQ(as_utf8("\xE2\x82"), "\\xE2\\x82");
  EXPECT_EQ(as_utf8(std::string_view("a\0b", 3)), std::string_view("a\0b", 3));
  EXPECT_EQ(as_utf8(""), "");
}

}  // namespace
}  // namespace hmax
