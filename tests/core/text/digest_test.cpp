#include "core/text/digest.hpp"

#include <gtest/gtest.h>

namespace hmax {
namespace {

// The published test vectors of FNV-1a, 64 bits.
TEST(Digest, IsFnv1a) {
  const auto of = [](std::string_view text) {
    Digest digest;
    digest.add(text);
    return digest.text();
  };
  EXPECT_EQ(of(""), "cbf29ce484222325");
  EXPECT_EQ(of("a"), "af63dc4c8601ec8c");
  EXPECT_EQ(of("foobar"), "85944171f73967e8");
}

}  // namespace
}  // namespace hmax
