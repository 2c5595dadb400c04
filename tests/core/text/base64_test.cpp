#include "core/text/base64.hpp"

#include <string>

#include <gtest/gtest.h>

namespace hmax {
namespace {

TEST(Base64, KnownTextsAndTheirWayBack) {
  EXPECT_EQ(encode_base64("Man"), "TWFu");
  EXPECT_EQ(encode_base64("Ma"), "TWE=");
  EXPECT_EQ(encode_base64("M"), "TQ==");
  EXPECT_EQ(decode_base64("TQ==TWE=TWFu"), "MMaMan");
  EXPECT_EQ(decode_base64(" TW\nFu"), "Man");
  EXPECT_EQ(decode_base64("TW*u"), std::nullopt);
  for (const char* damaged : {"TWF", "TQ=", "T===", "TQ=a", "=TQ="})
    EXPECT_EQ(decode_base64(damaged), std::nullopt) << damaged;
}

TEST(Base64, ReadsWhatItWritesOfEveryLength) {
  std::string bytes;
  for (int k = 0; k < 300; ++k) {
    EXPECT_EQ(decode_base64(encode_base64(bytes)), bytes);
    bytes += static_cast<char>(static_cast<unsigned char>(37 * k & 0xff));
  }
}

}  // namespace
}  // namespace hmax
