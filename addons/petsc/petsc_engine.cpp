/// The engine petsc: matrices on PETSc, eigenvalues by SLEPc. A module of its own, opened when it is asked
/// for.
#include <chrono>
#include <thread>
#include <unistd.h>
#include <utility>

#include "addons/petsc/petsc_calls.hpp"
#include "addons/petsc/structure_model.hpp"
#include "core/errors.hpp"
#include "core/ranks/silence.hpp"
#include "limits/distributed/distributed_engine.hpp"

namespace hmax::petsc {
namespace {

const MPI_Comm world = MPI_COMM_WORLD;

class Engine final : public DistributedEngine {
 public:
  Engine() {
    if (SlepcInitialize(nullptr, nullptr, nullptr, nullptr))
      throw InputError("the engine petsc does not start; see whether `mpirun -n 1 hmax doctor` does");
    static_cast<void>(PetscPopSignalHandler());  // hmax has its own
    static_cast<void>(PetscPushErrorHandler(keep_message, nullptr));
    MPI_Comm_rank(world, &rank_);
    MPI_Comm_size(world, &ranks_);
    if (rank_ == 0) return;
    error_ = silence_standard_streams();
  }
  ~Engine() override { static_cast<void>(SlepcFinalize()); }
  Engine(const Engine&) = delete;
  Engine& operator=(const Engine&) = delete;

  [[nodiscard]] int ranks() const override { return ranks_; }
  [[nodiscard]] std::string version() const override {
    return "PETSc " + number(PetscGetVersionNumber) + ", SLEPc " + number(SlepcGetVersionNumber);
  }

  std::unique_ptr<DistributedModel> read(DistributedStructure structure) override {
    std::unique_ptr<DistributedModel> model;
    together([&] { model = read_model(std::move(structure)); });
    return model;
  }

  void together(const std::function<void()>& work) override {
    std::string message;
    try {
      work();
    } catch (const std::exception& error) {
      message = error.what();
      if (message.empty()) message = "an error without a name";
    }
    throw_together(message);
  }

 private:
  using GetVersion = PetscErrorCode (*)(PetscInt*, PetscInt*, PetscInt*, PetscInt*);
  static std::string number(GetVersion get) {
    PetscInt major = 0, minor = 0, subminor = 0, release = 0;
    static_cast<void>(get(&major, &minor, &subminor, &release));
    return std::to_string(major) + "." + std::to_string(minor) + "." + std::to_string(subminor);
  }

  /// An error that all ranks came to is thrown by all; a rank that is alone with one ends them all, since the
  /// others wait for it.
  void throw_together(std::string message) const {
    MPI_Request request = MPI_REQUEST_NULL;
    MPI_Ibarrier(world, &request);
    int together = 0;
    const auto patience = std::chrono::steady_clock::now() + std::chrono::seconds(10);
    while (MPI_Test(&request, &together, MPI_STATUS_IGNORE), !together) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      if (message.empty() || std::chrono::steady_clock::now() < patience) continue;
      message.insert(0, "hmax: rank " + std::to_string(rank_) + ": ").push_back('\n');
      const ssize_t written = write(error_, message.data(), message.size());
      MPI_Abort(world, written < 0 ? 3 : 2);
    }
    int first = message.empty() ? ranks_ : rank_;
    MPI_Allreduce(MPI_IN_PLACE, &first, 1, MPI_INT, MPI_MIN, world);
    if (first == ranks_) return;
    auto length = static_cast<unsigned long>(message.size());
    MPI_Bcast(&length, 1, MPI_UNSIGNED_LONG, first, world);
    message.resize(length);
    MPI_Bcast(message.data(), static_cast<int>(length), MPI_CHAR, first, world);
    throw InputError(message);
  }

  int rank_ = 0, ranks_ = 1, error_ = STDERR_FILENO;
};

}  // namespace
}  // namespace hmax::petsc

// NOLINTNEXTLINE(readability-identifier-naming): found by its name
extern "C" __attribute__((visibility("default"))) std::unique_ptr<hmax::DistributedEngine>
hmax_make_distributed_engine() {
  return std::make_unique<hmax::petsc::Engine>();
}
