#include "addons/petsc/petsc_calls.hpp"

#include <stdexcept>

namespace hmax::petsc {

std::string& last_message() {
  static std::string message;
  return message;
}

PetscErrorCode keep_message(MPI_Comm /*comm*/, int /*line*/, const char* /*function*/, const char* /*file*/,
                            PetscErrorCode code, PetscErrorType type, const char* message,
                            void* /*context*/) {
  if (type == PETSC_ERROR_INITIAL && message) last_message() = message;
  return code;
}

void check(PetscErrorCode code, const std::string& what) {
  if (!code) return;
  std::string message = last_message();
  if (const std::size_t end = message.find('\n'); end != std::string::npos) message.resize(end);
  while (message.ends_with('!') || message.ends_with('.') || message.ends_with(' ')) message.pop_back();
  throw std::runtime_error(what + ": PETSc says \"" + message + "\"");
}

}  // namespace hmax::petsc
