#include "problems/mesh/files/xml_tags.hpp"

#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

#include "tests/says.hpp"

namespace hmax {
namespace {

TEST(XmlTags, CharactersByNameOrNumberAreThemselves) {
  EXPECT_EQ(unescaped("&lt;a&#123;&#x7B;&amp;&#xe9;&#8364;&#x1F600;"),
            "<a{{&\xC3\xA9\xE2\x82\xAC\xF0\x9F\x98\x80");
  // What is none stays.
  EXPECT_EQ(unescaped("&#0;&#;&#x;&#-1;&#x110000;&#12&;&unknown;&"),
            "&#0;&#;&#x;&#-1;&#x110000;&#12&;&unknown;&");
}

TEST(XmlTags, HaveAnAttributeOnce) {
  const std::string file = "<a b=\"1\" c=\"2\"/>\n<a b=\"1\" c=\"2\" b=\"1\"/>";
  const MeshText text("a.xml", file);
  const auto first = next_tag(text, file, 0);
  ASSERT_TRUE(first);
  EXPECT_EQ(first->attribute("c"), "2");
  EXPECT_TRUE(says(error_of<std::invalid_argument>([&] { next_tag(text, file, first->end); }),
                   "'b' of the tag 'a' is given twice; remove one"));
}

}  // namespace
}  // namespace hmax
