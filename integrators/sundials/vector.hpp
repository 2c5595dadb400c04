/// States as SUNDIALS sees them: its serial vector over the memory of an Eigen state, so that nothing is
/// copied on the way to a right-hand side.
#pragma once

#include <memory>
#include <new>
#include <nvector/nvector_serial.h>

#include <Eigen/Core>
#include <sundials/sundials_context.h>

namespace hmax::sundials {

/// What the library's serial operations read (length, data), with the state that owns the data behind it.
template <class State>
struct VectorContent : _N_VectorContent_Serial {
  State state;
};

/// The state that a vector made by make_vector holds.
template <class State>
State& state_of(N_Vector v) {
  return static_cast<VectorContent<State>*>(static_cast<_N_VectorContent_Serial*>(v->content))->state;
}

/// Frees a vector by its own function, and the state with it.
struct DestroyVector {
  void operator()(N_Vector v) const { N_VDestroy(v); }
};
using Vector = std::unique_ptr<_generic_N_Vector, DestroyVector>;

namespace detail {

/// Gives v a state of zeros, shape (length).
/// @returns false where memory ran out
template <class State>
bool fill_content(N_Vector v, sunindextype length) {
  // No exception may pass through the library, which clones vectors itself.
  auto* content = new (std::nothrow) VectorContent<State>;
  if (content == nullptr) return false;
  content->state.setZero(length);
  content->length = length;
  // The state owns the data, not the library.
  content->own_data = SUNFALSE;
  content->data = content->state.data();
  // The library reads the base class alone.
  v->content = static_cast<_N_VectorContent_Serial*>(content);
  return true;
}

/// Deletes the state, then the vector around it.
template <class State>
void destroy_vector(N_Vector v) {
  delete static_cast<VectorContent<State>*>(static_cast<_N_VectorContent_Serial*>(v->content));
  v->content = nullptr;
  N_VFreeEmpty(v);
}

/// The library clones its work vectors; a null pointer tells it that memory ran out.
template <class State>
N_Vector clone_vector(N_Vector like) {
  N_Vector v = N_VNewEmpty(like->sunctx);
  if (v == nullptr) return nullptr;
  // The clone has the operations of `like`, those that clone and destroy included.
  if (N_VCopyOps(like, v) == 0 && fill_content<State>(v, NV_LENGTH_S(like))) return v;
  N_VFreeEmpty(v);
  return nullptr;
}

}  // namespace detail

/// A vector of zeros, shape (n), with all serial operations of the library.
/// @throws std::bad_alloc
template <class State>
Vector make_vector(Eigen::Index n, SUNContext context) {
  // Only a source of operations: its own data are not used.
  const Vector serial(N_VNewEmpty_Serial(n, context));
  if (!serial) throw std::bad_alloc();
  // The serial operations of the library, with clones that own a state.
  serial->ops->nvclone = detail::clone_vector<State>;
  serial->ops->nvcloneempty = detail::clone_vector<State>;
  N_Vector made = detail::clone_vector<State>(serial.get());
  if (made == nullptr) throw std::bad_alloc();
  made->ops->nvdestroy = detail::destroy_vector<State>;
  return Vector(made);
}

}  // namespace hmax::sundials
