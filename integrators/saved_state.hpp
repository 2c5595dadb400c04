/// What a run carries from step to step, written to bytes and read back with every bit.
#pragma once

#include <algorithm>
#include <complex>
#include <cstdint>
#include <limits>
#include <tuple>
#include <type_traits>
#include <utility>
#include <variant>

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include "core/checkpoint_file.hpp"

namespace hmax {

// A class lists what it carries between two accepted steps once, for both directions:
//   void visit_state(auto& visit) { visit(h_, failures_); }
// Members may be numbers, enums, strings, pairs, complex numbers, variants, Eigen's dense and sparse
// matrices, containers of these, and classes with a visit_state of their own. What init() or start() makes
// from the system and the options again is left out, and so is what an attempt writes before it reads.
// Factors are not written: a stepper that keeps some has resumed(system), called after its state was read,
// which makes them again with the same bits from the same matrix.

namespace detail {
template <class T>
inline constexpr bool is_dense = std::is_base_of_v<Eigen::DenseBase<T>, T>;
template <class T>
inline constexpr bool is_sparse = std::is_base_of_v<Eigen::SparseMatrixBase<T>, T>;
/// M, K and C of a mechanical system; M is constant, and taken from the system again.
template <class T>
concept MechanicalParts = requires(T& value) {
  value.mass, value.stiffness, value.damping;
};
template <class T>
concept PairLike = requires(T& value) {
  value.first, value.second;
};
template <class T>
concept ComplexNumber = std::is_same_v<T, std::complex<double>> || std::is_same_v<T, std::complex<float>>;
template <class T>
concept VariantLike = requires(const T& value) {
  value.valueless_by_exception();
};
/// Containers of numbers side by side.
template <class T>
concept Numbers = requires(T& value) {
  value.data();
}
&&std::is_arithmetic_v<typename T::value_type>;
/// Containers whose size is part of their type: arrays.
template <class T>
concept FixedContainer = requires {
  std::tuple_size<T>::value;
};
}  // namespace detail

/// Visits what a run carries: appends it to bytes, or reads it back from them, in the same order. On loading
/// no memory is taken for a number in the bytes before what it counts is there.
/// @throws BadState  on loading, where the bytes end too early or are those of another shape
class StateVisitor {
 public:
  template <class... Members>
  void operator()(Members&... members) {
    (visit(members), ...);
  }

 protected:
  StateVisitor(StateBytes& bytes, bool loads) : bytes_(bytes), loads_(loads) {}

 private:
  template <class T>
  void visit(T& value) {
    if constexpr (requires { value.visit_state(*this); }) {
      value.visit_state(*this);
    } else if constexpr (std::is_enum_v<T>) {
      visit_as<std::underlying_type_t<T>>(value);
    } else if constexpr (std::is_same_v<T, bool>) {
      visit_as<std::uint8_t>(value);
    } else if constexpr (std::is_arithmetic_v<T>) {
      visit_elements(&value, 1);
    } else if constexpr (detail::ComplexNumber<T>) {
      visit_elements(reinterpret_cast<typename T::value_type*>(&value), 2);  // real, imaginary
    } else if constexpr (detail::VariantLike<T>) {
      auto index = static_cast<std::uint64_t>(value.index());
      visit(index);
      if (loads_) emplace(value, index, std::make_index_sequence<std::variant_size_v<T>>{});
      std::visit([&](auto& held) { visit(held); }, value);
    } else if constexpr (detail::MechanicalParts<T>) {
      (*this)(value.stiffness, value.damping);
    } else if constexpr (detail::is_sparse<T>) {
      visit_sparse(value);
    } else if constexpr (detail::is_dense<T>) {
      std::int64_t rows = value.rows(), cols = value.cols();
      (*this)(rows, cols);
      if (loads_) resize(value, rows, cols);
      visit_elements(value.data(), static_cast<std::size_t>(value.size()));
    } else if constexpr (detail::PairLike<T>) {
      (*this)(value.first, value.second);
    } else {
      visit_container(value);
    }
  }

  /// A value that stands in the bytes as a number of another type.
  template <class Number, class T>
  void visit_as(T& value) {
    Number number{};
    if (!loads_) number = static_cast<Number>(value);
    visit(number);
    if (loads_) value = static_cast<T>(number);
  }

  /// Makes the alternative with this index, unless it is there.
  template <class T, std::size_t... I>
  static void emplace(T& value, std::uint64_t index, std::index_sequence<I...>) {
    if (index >= sizeof...(I)) refuse();
    if (index != value.index()) ((index == I ? (void)emplace_default<I>(value) : (void)0), ...);
  }
  template <std::size_t I, class T>
  static void emplace_default(T& value) {
    if constexpr (std::is_default_constructible_v<std::variant_alternative_t<I, T>>)
      value.template emplace<I>();
    else
      refuse();  // made by the options of the run, which are the same
  }

  template <class T>
  void resize(T& value, std::int64_t rows, std::int64_t cols) {
    const auto most = static_cast<std::int64_t>(bytes_.left() / sizeof(typename T::Scalar));
    if (rows < 0 || cols < 0 || (cols > 0 && rows > most / cols)) refuse();  // before memory is taken
    if ((T::RowsAtCompileTime != Eigen::Dynamic && rows != T::RowsAtCompileTime) ||
        (T::ColsAtCompileTime != Eigen::Dynamic && cols != T::ColsAtCompileTime))
      refuse();
    value.resize(rows, cols);
  }

  template <class T>
  void visit_sparse(T& value) {
    using Index = typename T::StorageIndex;
    if (!loads_) value.makeCompressed();
    std::int64_t rows = value.rows(), cols = value.cols(), entries = value.nonZeros();
    (*this)(rows, cols, entries);
    if (loads_) {
      constexpr std::int64_t most = std::numeric_limits<Index>::max() - 1;
      if (rows < 0 || cols < 0 || entries < 0 || rows > most || cols > most || entries > most) refuse();
      bytes_.expect<Index>(static_cast<std::uint64_t>(cols + entries));
      value.resize(rows, cols);
      value.resizeNonZeros(entries);
    }
    visit_elements(value.outerIndexPtr(), static_cast<std::size_t>(cols) + 1);
    visit_elements(value.innerIndexPtr(), static_cast<std::size_t>(entries));
    visit_elements(value.valuePtr(), static_cast<std::size_t>(entries));
    // Columns in order, and rows within the matrix: what else it says no solver could bear.
    const Index *outer = value.outerIndexPtr(), *inner = value.innerIndexPtr();
    if (outer[0] != 0 || outer[cols] != entries || !std::is_sorted(outer, outer + cols + 1) ||
        !std::all_of(inner, inner + entries, [=](Index row) { return row >= 0 && row < rows; }))
      refuse();
  }

  template <class T>
  void visit_container(T& value) {
    auto size = static_cast<std::uint64_t>(value.size());
    visit(size);
    if constexpr (detail::FixedContainer<T>) {
      if (size != value.size()) refuse();
    } else if constexpr (detail::Numbers<T>) {
      if (loads_) bytes_.expect<typename T::value_type>(size);
      value.resize(size);
    } else if (loads_) {
      value.clear();
      for (std::uint64_t i = 0; i < size; ++i) {  // ends where the bytes do
        value.push_back({});
        visit(value.back());
      }
      return;
    }
    if constexpr (detail::Numbers<T>)
      visit_elements(value.data(), value.size());
    else
      for (auto& element : value) visit(element);
  }

  template <class T>
  void visit_elements(T* elements, std::size_t count) {
    if constexpr (!std::is_arithmetic_v<T>)
      for (std::size_t i = 0; i < count; ++i) visit(elements[i]);
    else if (loads_)
      bytes_.take_all(elements, count);
    else
      bytes_.put_all(elements, count);
  }

  [[noreturn]] static void refuse() { throw BadState("the state has another shape"); }

  StateBytes& bytes_;
  bool loads_;
};

/// Appends what it visits.
struct StateSaver : StateVisitor {
  explicit StateSaver(StateBytes& bytes) : StateVisitor(bytes, false) {}
};
/// Reads into what it visits.
struct StateLoader : StateVisitor {
  explicit StateLoader(StateBytes& bytes) : StateVisitor(bytes, true) {}
};

/// The counts of an implicit method; why equations were not solved is told by the attempt that ends a run.
void visit_work(auto& visit, auto& work) {
  visit(work.factorisations, work.newton, work.linear_iterations, work.newton_error);
}

/// Classes that list what they carry.
template <class T>
concept SavesState = requires(T& value, StateVisitor& visit) {
  value.visit_state(visit);
};

}  // namespace hmax
