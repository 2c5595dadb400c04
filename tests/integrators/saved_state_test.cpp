#include "integrators/saved_state.hpp"

#include <array>
#include <cmath>
#include <complex>
#include <cstdint>
#include <limits>
#include <string>
#include <variant>
#include <vector>

#include <gtest/gtest.h>

namespace hmax {
namespace {

/// One member of each kind.
struct Members {
  enum class Word : std::uint8_t { first, second };
  Word word = Word::first;
  bool flag = false;
  std::complex<double> s;
  std::string text;
  Eigen::Vector2d small = Eigen::Vector2d::Zero();
  Eigen::MatrixXd dense;
  Eigen::SparseMatrix<double> sparse;
  std::array<Eigen::VectorXd, 2> slopes;
  std::variant<double, Eigen::VectorXd> either;
  std::vector<std::pair<double, std::string>> frames;

  void visit_state(auto& visit) { visit(word, flag, s, text, small, dense, sparse, slopes, either, frames); }
};

Members sample() {
  Members m;
  m.word = Members::Word::second;
  m.flag = true;
  m.s = {-0.0, std::numeric_limits<double>::denorm_min()};
  m.text = std::string("a\0b", 3);
  m.small << 1, 0.1;
  m.dense = Eigen::MatrixXd::Random(3, 2);
  m.sparse.resize(3, 3);
  m.sparse.insert(2, 0) = 0.3;  // not compressed
  m.sparse.insert(0, 1) = -7;
  m.slopes[1] = Eigen::VectorXd::Random(4);
  m.either = Eigen::VectorXd(Eigen::VectorXd::Random(2));
  m.frames = {{0.1, "one"}, {0.2, ""}};
  return m;
}

std::string bytes_of(Members& members) {
  StateBytes bytes;
  StateSaver save(bytes);
  save(members);
  return bytes.bytes();
}

Members loaded(const std::string& text) {
  StateBytes bytes(text);
  StateLoader load(bytes);
  Members members;
  load(members);
  EXPECT_TRUE(bytes.at_end());
  return members;
}

TEST(SavedState, KeepsEveryBitOfEveryKind) {
  Members saved = sample();
  const std::string bytes = bytes_of(saved);
  Members read = loaded(bytes);
  EXPECT_EQ(bytes_of(read), bytes);
  EXPECT_EQ(read.text, saved.text);
  EXPECT_TRUE(std::signbit(read.s.real()));
  EXPECT_EQ(read.dense, saved.dense);
  EXPECT_EQ(Eigen::MatrixXd(read.sparse), Eigen::MatrixXd(saved.sparse));
  EXPECT_EQ(read.slopes[0].size(), 0);
  EXPECT_EQ(std::get<Eigen::VectorXd>(read.either), std::get<Eigen::VectorXd>(saved.either));
  EXPECT_EQ(read.frames, saved.frames);
}

TEST(SavedState, EndsInAnErrorWhereBytesAreMissing) {
  Members saved = sample();
  const std::string bytes = bytes_of(saved);
  for (std::size_t length = 0; length < bytes.size(); ++length)
    EXPECT_THROW(loaded(bytes.substr(0, length)), BadState) << length;
}

TEST(SavedState, NeverCrashesOnBytesThatAreOthers) {
  Members saved = sample();
  const std::string bytes = bytes_of(saved);
  // A count of any size may come out of it, and no memory is taken for it.
  for (std::size_t at = 0; at < bytes.size(); ++at)
    for (const int flip : {0x01, 0x10, 0x80, 0xff}) {
      std::string other = bytes;
      other[at] = static_cast<char>(other[at] ^ flip);
      StateBytes state(other);
      StateLoader load(state);
      Members members;
      try {
        load(members);
      } catch (const BadState&) {
      }
    }
}

}  // namespace
}  // namespace hmax
