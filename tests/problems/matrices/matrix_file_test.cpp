#include "problems/matrices/matrix_file.hpp"

#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>

#include "problems/matrices/matrix_readers.hpp"
#include "problems/matrices/matrix_writers.hpp"
#include "tests/problems/matrices/matrix_samples.hpp"
#include "tests/says.hpp"

namespace hmax {
namespace {

std::string refusal(const std::string& name, const std::string& bytes) {
  return error_of<std::invalid_argument>([&] {
    const MatrixFile file = matrix_from(name, bytes);
    (void)assembled(file, file.rows, file.columns);
  });
}

void expect_refusal(const std::string& bytes, const std::string& part, const std::string& name = "K.mtx") {
  EXPECT_TRUE(says(refusal(name, bytes), part));
}

const std::string real_general = "%%MatrixMarket matrix coordinate real general\n";

TEST(MatrixFiles, AreReadInEveryFormat) {
  for (const MatrixSample& sample : matrix_samples()) {
    SCOPED_TRACE(sample.name);
    const MatrixFile file = matrix_from(sample.name, sample.bytes);
    EXPECT_EQ(Eigen::MatrixXd(assembled(file, 3, 3)), sample.matrix);
  }
}

TEST(MatrixFiles, EntriesOfOnePlaceAreAddedAndCounted) {
  std::size_t repeated = 0;
  const MatrixFile general = matrix_from("K.mtx", real_general + "2 2 4\n1 1 1\n1 1 2\n1 2 5\n2 2 1\n");
  EXPECT_EQ(assembled(general, 2, 2, &repeated).coeff(0, 0), 3);
  EXPECT_EQ(repeated, 1U);
  const MatrixFile half = matrix_from(
      "K.mtx", "%%MatrixMarket matrix coordinate real symmetric\n2 2 5\n1 1 1\n1 1 2\n2 1 5\n2 1 1\n2 2 1\n");
  EXPECT_EQ(assembled(half, 2, 2, &repeated).coeff(0, 1), 6);
  EXPECT_EQ(repeated, 2U);
}

TEST(MatrixFiles, OneTriangleOfAGeneralFileIsFound) {
  EXPECT_TRUE(is_one_triangle(matrix_from("K.mtx", real_general + "2 2 3\n1 1 1\n2 1 5\n2 2 1\n")));
  EXPECT_FALSE(is_one_triangle(matrix_from("K.mtx", real_general + "2 2 4\n1 1 1\n2 1 5\n1 2 5\n2 2 1\n")));
  EXPECT_FALSE(is_one_triangle(matrix_from("M.mtx", real_general + "2 2 2\n1 1 1\n2 2 1\n")));
}

TEST(MatrixFiles, AreRefusedWithLineAndRemedy) {
  expect_refusal(real_general + "2 2 2\n1 1 1\n0 2 1\n",
                 "K.mtx, line 4: the row is '0' but must lie between 1 and 2");
  expect_refusal(real_general + "2 2 2\n1 1 1\n2 3 1\n", "line 4: the column is '3'");
  expect_refusal(real_general + "2 2 2\n1 1 nan\n2 2 1\n",
                 "line 3: the value is 'nan' but must be a finite number");
  expect_refusal(real_general + "2 2 2\n1 1 1e999\n2 2 1\n", "but must be a finite number");
  expect_refusal(real_general + "2 2 3\n1 1 1.00000\n2 2 1.00000\n",
                 "ends after 2 of 3 entries; it is cut off");
  expect_refusal(real_general + "2 2 1\n1 1 1\n2 2 1\n", "line 4: the file goes on behind its last entry");
  expect_refusal(real_general + "2 2 1\n1 1 1", "the last line has no line break");
  expect_refusal(real_general + "2 2 1\n1 1 1 0\n",
                 "the line has 4 words but an entry is row, column and value");
  expect_refusal(real_general + "2 2 1\n1 1,5 1\n", "the column should be a whole number and is '1,5'");
  expect_refusal(real_general + "2 2 2000000000\n1 1 1\n",
                 "announces 2000000000 entries, and the file has only");
  expect_refusal(real_general, "the line with the size is missing");
  expect_refusal("%%MatrixMarket matrix coordinate complex general\n1 1 1\n1 1 1 0\n",
                 "line 1: the entries are complex");
  expect_refusal("%%MatrixMarket matrix coordinate complex hermitian\n1 1 1\n1 1 1 0\n", "models are real");
  expect_refusal("%%MatrixMarket matrix coordinate real hermitian\n1 1 1\n1 1 1\n", "Hermitian");
  expect_refusal("%%MatrixMarket matrix coordinate pattern general\n1 1 1\n1 1\n",
                 "a pattern without values");
  expect_refusal("%%MatrixMarket matrix coordinate real\n1 1 1\n1 1 1\n", "the header has 4 words");
  expect_refusal("%%MatrixMarket matrix coordinate real symmetric\n2 2 3\n1 1 1\n2 1 5\n1 2 5\n",
                 "entries stand on both sides of the diagonal");
  expect_refusal("%%MatrixMarket matrix coordinate real symmetric\n2 3 1\n1 1 1\n", "is square");
  expect_refusal("%%MatrixMarket matrix coordinate real skew-symmetric\n2 2 1\n1 1 1\n",
                 "zeros on its diagonal");
  expect_refusal("%%MatrixMarket matrix array real general\n2 2\n1\n2\n3\n", "cut off");
  expect_refusal("1 1 3\n", "neither Matrix Market");
  expect_refusal("\x1f\x8b\x08", "unpack it with gunzip");
  expect_refusal(std::string("PK\x03\x04"), "scipy.io.mmwrite");
  expect_refusal("Mat Object: 1 MPI process\n  type: seqaij\nrow 0: (0, 1.)\n",
                 "view the object with a binary viewer");
  expect_refusal("%Mat Object: 1 MPI process\n", "view the object with a binary viewer", "K.m");
  expect_refusal("**\n** GENERATION OF SUBSTRUCTURE\n*USER ELEMENT,NODES=         75,LINEAR\n",
                 "SOLVER=MATRIXSTORAGE");
  expect_refusal("", "the file is empty");
  expect_refusal("1 1 3\n1 2\n", "job.sti, line 2: the line has 2 words", "job.sti");
}

TEST(MatrixFiles, OfPetscAreRefusedWithTheByte) {
  const Eigen::Matrix2d matrix{{2, -1}, {-1, 2}};
  const std::string whole = petsc_bytes<std::int32_t>(matrix);
  expect_refusal(whole.substr(0, whole.size() - 1), "it is cut off", "K.bin");
  expect_refusal(whole + std::string(8, '\0'), "8 bytes follow the last value; give one real matrix a file",
                 "K.bin");
  std::string far = whole;
  far[24 + 3] = 9;  // the first column
  expect_refusal(far, "has the column 10 (counted from 1), and the matrix has 2", "K.bin");
  std::string endless = whole;
  endless[4] = 0x7f;
  expect_refusal(endless, "K.bin, byte 16: the header announces", "K.bin");
}

TEST(MatrixFiles, VectorsAndFullMatricesOfPetscAreRead) {
  std::string vector;
  append_bytes(vector, std::int32_t{1211214});
  append_bytes(vector, std::int32_t{2});
  append_bytes(vector, 1.5);
  append_bytes(vector, 0.0);
  EXPECT_EQ(column_of(matrix_from("q.bin", vector), 0), Eigen::Vector2d(1.5, 0));
  std::string full;
  for (const std::int32_t number : {1211216, 1, 2, -1}) append_bytes(full, number);
  append_bytes(full, 3.0);
  append_bytes(full, 4.0);
  EXPECT_EQ(Eigen::MatrixXd(assembled(matrix_from("K.bin", full), 1, 2)), Eigen::RowVector2d(3, 4));
}

TEST(MatrixFiles, NumbersHaveTheNotationsOfCAndFortran) {
  EXPECT_EQ(number_in("1.5"), 1.5);
  EXPECT_EQ(number_in("+1.5D+02"), 150);
  EXPECT_EQ(number_in("-1.5d-2"), -0.015);
  EXPECT_EQ(number_in("1.0-101"), 1e-101);
  EXPECT_EQ(number_in("1.0D-400"), 0);
  EXPECT_EQ(number_in(".5"), 0.5);
  for (const char* wrong : {"", "+", "-", "1.5x", "1,5", "++1", "1e", "0x10", "D", "1.0D", "--1"})
    EXPECT_TRUE(std::isnan(number_in(wrong))) << wrong;
}

TEST(MatrixFiles, AreWrittenAndReadAsTheSameDoubles) {
  const Eigen::Matrix2d symmetric{{1.0 / 3, -1e-300}, {-1e-300, 2e17}}, general{{0.1, 0.2}, {0.3, 0.4}};
  for (const Eigen::Matrix2d& matrix : {symmetric, general}) {
    const std::string text =
        matrix_market_text(Eigen::SparseMatrix<double>(matrix.sparseView()), "stiffness");
    EXPECT_EQ(Eigen::MatrixXd(assembled(matrix_from("K.mtx", text), 2, 2)), matrix) << text;
  }
}

}  // namespace
}  // namespace hmax
