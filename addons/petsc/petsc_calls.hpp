/// Calls of PETSc and MPI: their errors as exceptions, their objects with an owner.
#pragma once

#include <slepceps.h>
#include <slepcpep.h>
#include <string>
#include <utility>

namespace hmax::petsc {

/// What PETSc said of the last error.
std::string& last_message();

/// Keeps the message for the sentence of hmax, and prints nothing; a PETSc error handler.
PetscErrorCode keep_message(MPI_Comm comm, int line, const char* function, const char* file,
                            PetscErrorCode code, PetscErrorType type, const char* message, void* context);

/// @throws std::runtime_error  `what` and the message of PETSc, where the code is that of an error
void check(PetscErrorCode code, const std::string& what);

/// An object of PETSc with one owner.
template <class Object, PetscErrorCode (*destroy)(Object*)>
class Owned {
 public:
  Owned() = default;
  Owned(Owned&& other) noexcept : object_(std::exchange(other.object_, nullptr)) {}
  Owned& operator=(Owned&& other) noexcept {
    std::swap(object_, other.object_);
    return *this;
  }
  ~Owned() {
    if (object_) static_cast<void>(destroy(&object_));
  }
  /// For functions that make the object.
  Object* out() { return &object_; }
  operator Object() const { return object_; }  // NOLINT(google-explicit-constructor): it is that object
 private:
  Object object_ = nullptr;
};
/// A vector of PETSc over memory of somebody else, while this lives.
class Placed {
 public:
  Placed(Vec vector, const double* values) : vector_(vector) {
    check(VecPlaceArray(vector, values), "a vector is not placed");
  }
  ~Placed() { static_cast<void>(VecResetArray(vector_)); }
  Placed(const Placed&) = delete;
  Placed& operator=(const Placed&) = delete;

 private:
  Vec vector_;
};

using Matrix = Owned<Mat, MatDestroy>;
using Vector = Owned<Vec, VecDestroy>;
using Viewer = Owned<PetscViewer, PetscViewerDestroy>;
using Solver = Owned<EPS, EPSDestroy>;
using LinearSolver = Owned<KSP, KSPDestroy>;
using PolynomialSolver = Owned<PEP, PEPDestroy>;

}  // namespace hmax::petsc
