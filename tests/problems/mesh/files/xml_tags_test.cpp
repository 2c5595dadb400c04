#include "problems/mesh/files/xml_tags.hpp"

#include <gtest/gtest.h>

namespace hmax {
namespace {

TEST(XmlTags, CharactersByNameOrNumberAreThemselves) {
  EXPECT_EQ(unescaped("&lt;a&#123;&#x7B;&amp;&#xe9;&#8364;&#x1F600;"),
            "<a{{&\xC3\xA9\xE2\x82\xAC\xF0\x9F\x98\x80");
  // What is none stays.
  EXPECT_EQ(unescaped("&#0;&#;&#x;&#-1;&#x110000;&#12&;&unknown;&"),
            "&#0;&#;&#x;&#-1;&#x110000;&#12&;&unknown;&");
}

}  // namespace
}  // namespace hmax
