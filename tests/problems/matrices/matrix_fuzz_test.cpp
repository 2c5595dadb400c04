/// Matrix files that were cut off or damaged anywhere: every one is refused in a sentence or read as a matrix
/// whose indices and numbers can be relied on, and none asks for memory that it does not fill.
#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>

#include "tests/problems/matrices/matrix_samples.hpp"

namespace hmax {
namespace {

/// True when the damaged file was refused.
bool refused(const std::string& name, const std::string& bytes) {
  try {
    const MatrixFile file = matrix_from(name, bytes);
    EXPECT_LE(file.entries.capacity(), bytes.size());
    for (const MatrixEntry& entry : file.entries) {
      EXPECT_TRUE(entry.row() >= 0 && entry.row() < file.rows);
      EXPECT_TRUE(entry.col() >= 0 && entry.col() < file.columns);
      EXPECT_TRUE(std::isfinite(entry.value()));
    }
    return false;
  } catch (const std::invalid_argument& error) {
    const std::string sentence = error.what();
    EXPECT_EQ(sentence.find('\n'), std::string::npos) << sentence;
    EXPECT_TRUE(sentence.starts_with(name)) << sentence;
    return true;
  }
}

TEST(DamagedMatrixFiles, CutOffAnywhereTheyAreRefused) {
  for (const MatrixSample& sample : matrix_samples()) {
    SCOPED_TRACE(sample.name);
    for (std::size_t size = 0; size < sample.bytes.size(); ++size) {
      // CalculiX marks no end: a file that is cut between lines is one of fewer entries.
      const bool whole_lines = sample.name.ends_with(".sti") && size > 0 && sample.bytes[size - 1] == '\n';
      EXPECT_TRUE(refused(sample.name, sample.bytes.substr(0, size)) || whole_lines) << size;
    }
  }
}

TEST(DamagedMatrixFiles, WithAWrongByteAnywhereTheyAreRefusedOrValid) {
  for (const MatrixSample& sample : matrix_samples()) {
    SCOPED_TRACE(sample.name);
    for (std::size_t i = 0; i < sample.bytes.size(); ++i)
      for (const char byte : {'5', '9', '-', '.', ' ', '\n', '\r', '%', '\0', '\x7f', '\xff', 'e', 'D'}) {
        std::string damaged = sample.bytes;
        damaged[i] = byte;
        refused(sample.name, damaged);
      }
  }
}

TEST(DamagedMatrixFiles, WithWordsPutInOrBytesLostTheyAreRefusedOrValid) {
  for (const MatrixSample& sample : matrix_samples()) {
    SCOPED_TRACE(sample.name);
    for (std::size_t i = 0; i < sample.bytes.size(); ++i) {
      for (const char* words :
           {"99999999", "-1 ", " nan ", " 4000000000 ", "1e300", "9999999999999999999999"}) {
        std::string damaged = sample.bytes;
        refused(sample.name, damaged.insert(i, words));
      }
      for (const std::size_t lost : {1U, 4U, 8U}) {
        std::string damaged = sample.bytes;
        refused(sample.name, damaged.erase(i, lost));
      }
    }
  }
}

}  // namespace
}  // namespace hmax
