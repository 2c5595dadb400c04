/// PETSc binary [balay2022petsc], as PetscViewerBinaryOpen writes matrices and vectors.
#include <cmath>
#include <stdexcept>
#include <string>

#include "problems/matrices/matrix_readers.hpp"
#include "problems/mesh/files/mesh_text.hpp"

namespace hmax {
namespace {

constexpr std::int64_t matrix_id = 1211216, vector_id = 1211214;

/// Reads forward; places are bytes, from 0.
class Bytes {
 public:
  Bytes(std::string name, std::string_view bytes) : name_(std::move(name)), bytes_(bytes) {}

  [[nodiscard]] std::size_t left() const { return bytes_.size() - at_; }
  template <class T>
  T take(const char* what) {
    if (left() < sizeof(T)) fail("the file ends where " + std::string(what) + " should be; export it again");
    const T value = value_from<T>(bytes_.data() + at_, true);
    at_ += sizeof(T);
    return value;
  }
  std::int64_t index(const char* what, bool wide) {
    return wide ? take<std::int64_t>(what) : take<std::int32_t>(what);
  }
  [[noreturn]] void fail(const std::string& text) const {
    throw std::invalid_argument(name_ + ", byte " + std::to_string(at_) + ": " + text);
  }
  void require_room(std::uint64_t count, std::size_t bytes, const char* what) const {
    if (count > left() / bytes)
      fail("the header announces " + std::to_string(count) + " " + what + ", and the file has only " +
           std::to_string(left()) + " more bytes; it is cut off, so export it again");
  }
  double number() {
    const auto value = take<double>("a value");
    if (!std::isfinite(value)) {
      at_ -= sizeof(double);
      fail(
          "a value is not finite; export the matrix again, in double precision and from a build with real numbers");
    }
    return value;
  }
  void require_end() const {
    if (left() > 0)
      fail(std::to_string(left()) +
           " bytes follow the last value; give one real matrix a file, complex numbers and "
           "several objects are not read");
  }

 private:
  std::string name_;
  std::string_view bytes_;
  std::size_t at_ = 0;
};

/// Whether indices have 64 bits: then the number that starts the file has as well.
bool is_wide(std::string_view bytes) {
  return bytes.size() >= 8 && value_from<std::int32_t>(bytes.data(), true) == 0;
}

std::int64_t size_of(Bytes& bytes, const char* what, bool wide) {
  const std::int64_t size = bytes.index(what, wide);
  if (size < 1 || size > most_matrix_rows)
    bytes.fail(std::string(what) + " is " + std::to_string(size) + " but must lie between 1 and " +
               std::to_string(most_matrix_rows) + "; export the matrix again");
  return size;
}

void read_rows(Bytes& bytes, MatrixFile& file, std::int64_t entries, bool wide) {
  const std::size_t of_index = wide ? 8 : 4;
  bytes.require_room(static_cast<std::uint64_t>(file.rows), of_index, "rows");
  std::vector<std::int64_t> lengths;
  lengths.reserve(static_cast<std::size_t>(file.rows));
  std::int64_t sum = 0;
  for (Eigen::Index i = 0; i < file.rows; ++i) {
    lengths.push_back(bytes.index("the length of a row", wide));
    if (lengths.back() < 0 || lengths.back() > entries - sum)
      bytes.fail("row " + std::to_string(i + 1) + " has " + std::to_string(lengths.back()) +
                 " entries, and " + std::to_string(entries - sum) +
                 " of all are left; export the matrix again");
    sum += lengths.back();
  }
  if (sum != entries)
    bytes.fail("the rows have " + std::to_string(sum) + " entries, and the header announces " +
               std::to_string(entries) + "; export the matrix again");
  bytes.require_room(static_cast<std::uint64_t>(entries), of_index + sizeof(double), "entries");
  file.entries.reserve(static_cast<std::size_t>(entries));
  for (Eigen::Index i = 0; i < file.rows; ++i)
    for (std::int64_t k = 0; k < lengths[static_cast<std::size_t>(i)]; ++k) {
      const std::int64_t j = bytes.index("a column", wide);
      if (j < 0 || j >= file.columns)
        bytes.fail("an entry of row " + std::to_string(i + 1) + " has the column " + std::to_string(j + 1) +
                   " (counted from 1), and the matrix has " + std::to_string(file.columns) +
                   "; export the matrix again");
      file.entries.emplace_back(static_cast<int>(i), static_cast<int>(j), 0.0);
    }
  for (MatrixEntry& entry : file.entries) entry = {entry.row(), entry.col(), bytes.number()};
}

/// Row by row.
void read_dense(Bytes& bytes, MatrixFile& file) {
  bytes.require_room(static_cast<std::uint64_t>(file.rows) * static_cast<std::uint64_t>(file.columns),
                     sizeof(double), "values");
  for (Eigen::Index i = 0; i < file.rows; ++i)
    for (Eigen::Index j = 0; j < file.columns; ++j)
      if (const double value = bytes.number(); value != 0)
        file.entries.emplace_back(static_cast<int>(i), static_cast<int>(j), value);
}

}  // namespace

bool is_petsc(std::string_view bytes) {
  const auto is_id = [](std::int64_t id) { return id == matrix_id || id == vector_id; };
  return (bytes.size() >= 4 && is_id(value_from<std::int32_t>(bytes.data(), true))) ||
         (bytes.size() >= 8 && is_id(value_from<std::int64_t>(bytes.data(), true)));
}

MatrixFile read_petsc(const std::string& name, std::string_view text) {
  Bytes bytes(name, text);
  const bool wide = is_wide(text);
  const bool is_vector = bytes.index("the kind of the object", wide) == vector_id;
  MatrixFile file{.name = name, .format = "PETSc binary", .columns = 1};
  file.rows = size_of(bytes, "the number of rows", wide);
  if (is_vector) {
    read_dense(bytes, file);
  } else {
    file.columns = size_of(bytes, "the number of columns", wide);
    const std::int64_t entries = bytes.index("the number of entries", wide);
    // -1 stands for a matrix without zeros left out.
    if (entries < -1 || entries > most_matrix_rows)
      bytes.fail("the number of entries is " + std::to_string(entries) + "; export the matrix again");
    if (entries == -1)
      read_dense(bytes, file);
    else
      read_rows(bytes, file, entries, wide);
  }
  bytes.require_end();
  return file;
}

}  // namespace hmax
