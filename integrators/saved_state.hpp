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
//   template <class Visitor> void visit_state(Visitor& visit) { visit(h_, failures_); }
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
concept Complex = std::is_same_v<T, std::complex<double>> || std::is_same_v<T, std::complex<float>>;
template <class T>
concept VariantLike = requires(const T& value) {
  value.valueless_by_exception();
};
template <class T>
concept Contiguous = requires(T& value) {
  value.data();
};
/// Containers whose size is part of their type: arrays.
template <class T>
concept FixedContainer = requires {
  std::tuple_size<T>::value;
};
}  // namespace detail

/// Appends what it visits.
class StateSaver {
 public:
  explicit StateSaver(StateBytes& bytes) : bytes_(bytes) {}

  template <class... Members>
  void operator()(Members&... members) {
    (put(members), ...);
  }

 private:
  template <class T>
  void put(T& value) {
    if constexpr (requires { value.visit_state(*this); }) {
      value.visit_state(*this);
    } else if constexpr (std::is_enum_v<T>) {
      bytes_.put(static_cast<std::underlying_type_t<T>>(value));
    } else if constexpr (std::is_same_v<T, bool>) {
      bytes_.put(static_cast<std::uint8_t>(value));
    } else if constexpr (std::is_arithmetic_v<T>) {
      bytes_.put(value);
    } else if constexpr (detail::Complex<T>) {
      bytes_.put(value.real());
      bytes_.put(value.imag());
    } else if constexpr (detail::VariantLike<T>) {
      bytes_.put(static_cast<std::uint64_t>(value.index()));
      std::visit([&](auto& held) { put(held); }, value);
    } else if constexpr (detail::MechanicalParts<T>) {
      (*this)(value.stiffness, value.damping);
    } else if constexpr (detail::is_sparse<T>) {
      value.makeCompressed();
      bytes_.put(static_cast<std::int64_t>(value.rows()));
      bytes_.put(static_cast<std::int64_t>(value.cols()));
      bytes_.put(static_cast<std::int64_t>(value.nonZeros()));
      const auto entries = static_cast<std::size_t>(value.nonZeros());
      put_elements(value.outerIndexPtr(), static_cast<std::size_t>(value.outerSize()) + 1);
      put_elements(value.innerIndexPtr(), entries);
      put_elements(value.valuePtr(), entries);
    } else if constexpr (detail::is_dense<T>) {
      bytes_.put(static_cast<std::int64_t>(value.rows()));
      bytes_.put(static_cast<std::int64_t>(value.cols()));
      put_elements(value.data(), static_cast<std::size_t>(value.size()));
    } else if constexpr (detail::PairLike<T>) {
      (*this)(value.first, value.second);
    } else {
      bytes_.put(static_cast<std::uint64_t>(value.size()));
      if constexpr (detail::Contiguous<T>)
        put_elements(value.data(), value.size());
      else
        for (auto& element : value) put(element);
    }
  }

  template <class T>
  void put_elements(T* elements, std::size_t count) {
    if constexpr (std::is_arithmetic_v<T>)
      bytes_.put_all(elements, count);
    else
      for (std::size_t i = 0; i < count; ++i) put(elements[i]);
  }

  StateBytes& bytes_;
};

/// Reads into what it visits, in the same order. No memory is taken for a number in the bytes before what it
/// counts is there. @throws BadState  where the bytes end too early or are those of another shape
class StateLoader {
 public:
  explicit StateLoader(StateBytes& bytes) : bytes_(bytes) {}

  template <class... Members>
  void operator()(Members&... members) {
    (take(members), ...);
  }

 private:
  template <class T>
  void take(T& value) {
    if constexpr (requires { value.visit_state(*this); }) {
      value.visit_state(*this);
    } else if constexpr (std::is_enum_v<T>) {
      value = static_cast<T>(bytes_.take<std::underlying_type_t<T>>());
    } else if constexpr (std::is_same_v<T, bool>) {
      value = bytes_.take<std::uint8_t>() != 0;
    } else if constexpr (std::is_arithmetic_v<T>) {
      value = bytes_.take<T>();
    } else if constexpr (detail::Complex<T>) {
      using Part = typename T::value_type;
      const Part real = bytes_.take<Part>();
      value = T(real, bytes_.take<Part>());
    } else if constexpr (detail::VariantLike<T>) {
      emplace(value, bytes_.take<std::uint64_t>(), std::make_index_sequence<std::variant_size_v<T>>{});
      std::visit([&](auto& held) { take(held); }, value);
    } else if constexpr (detail::MechanicalParts<T>) {
      (*this)(value.stiffness, value.damping);
    } else if constexpr (detail::is_sparse<T>) {
      take_sparse(value);
    } else if constexpr (detail::is_dense<T>) {
      const auto rows = bytes_.take<std::int64_t>(), cols = bytes_.take<std::int64_t>();
      resize(value, rows, cols);
      take_elements(value.data(), static_cast<std::size_t>(value.size()));
    } else if constexpr (detail::PairLike<T>) {
      (*this)(value.first, value.second);
    } else {
      take_container(value);
    }
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
  void take_sparse(T& value) {
    using Index = typename T::StorageIndex;
    const auto rows = bytes_.take<std::int64_t>(), cols = bytes_.take<std::int64_t>(),
               entries = bytes_.take<std::int64_t>();
    constexpr std::int64_t most = std::numeric_limits<Index>::max() - 1;
    if (rows < 0 || cols < 0 || entries < 0 || rows > most || cols > most || entries > most) refuse();
    bytes_.expect<Index>(static_cast<std::uint64_t>(cols + entries));
    value.resize(rows, cols);
    value.resizeNonZeros(entries);
    const auto count = static_cast<std::size_t>(entries);
    take_elements(value.outerIndexPtr(), static_cast<std::size_t>(cols) + 1);
    take_elements(value.innerIndexPtr(), count);
    take_elements(value.valuePtr(), count);
    // Columns in order, and rows within the matrix: what else it says no solver could bear.
    const Index *outer = value.outerIndexPtr(), *inner = value.innerIndexPtr();
    if (outer[0] != 0 || outer[cols] != entries || !std::is_sorted(outer, outer + cols + 1) ||
        !std::all_of(inner, inner + entries, [=](Index row) { return row >= 0 && row < rows; }))
      refuse();
  }

  template <class T>
  void take_container(T& value) {
    const auto size = bytes_.take<std::uint64_t>();
    if constexpr (detail::FixedContainer<T>) {
      if (size != value.size()) refuse();
      take_elements(value.data(), value.size());
    } else if constexpr (detail::Contiguous<T> && std::is_arithmetic_v<typename T::value_type>) {
      bytes_.expect<typename T::value_type>(size);
      value.resize(size);
      take_elements(value.data(), value.size());
    } else {
      value.clear();
      for (std::uint64_t i = 0; i < size; ++i) {  // ends where the bytes do
        value.push_back({});
        take(value.back());
      }
    }
  }

  template <class T>
  void take_elements(T* elements, std::size_t count) {
    if constexpr (std::is_arithmetic_v<T>)
      bytes_.take_all(elements, count);
    else
      for (std::size_t i = 0; i < count; ++i) take(elements[i]);
  }

  [[noreturn]] static void refuse() { throw BadState("the state has another shape"); }

  StateBytes& bytes_;
};

/// The counts of an implicit method; why equations were not solved is told by the attempt that ends a run.
template <class Visitor, class Work>
void visit_work(Visitor& visit, Work& work) {
  visit(work.factorisations, work.newton, work.linear_iterations, work.newton_error);
}

/// Classes that list what they carry.
template <class T>
concept SavesState = requires(T& value, StateSaver& saver) {
  value.visit_state(saver);
};

}  // namespace hmax
