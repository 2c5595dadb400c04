/// The device of a GPU by CUDA: memory, launches, graphs and events.
#include <algorithm>
#include <array>
#include <cstdint>
#include <cuda_runtime.h>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "catalogue/device/device.hpp"
#include "catalogue/device/programs/device_program.hpp"
#include "core/errors.hpp"

namespace hmax {
namespace {

constexpr std::size_t shared_by_default = 48 << 10;
constexpr std::size_t launches_of_a_graph = 64;  // or more, where steps that follow one another are more

void check(cudaError_t error, const char* what) {
  if (error == cudaSuccess) return;
  static_cast<void>(cudaGetLastError());  // it is told here, and not of what comes after it
  throw InputError(std::string("the GPU ") + what + ": " + cudaGetErrorString(error) +
                   "; see nvidia-smi, or leave out --device");
}

struct CudaBlock {
  template <class F>
  __device__ void each(std::int32_t count, const F& f) const {
    for (std::int32_t n = static_cast<std::int32_t>(threadIdx.x); n < count;
         n += static_cast<std::int32_t>(blockDim.x))
      f(n);
  }
  __device__ void barrier() const { __syncthreads(); }
};

// Coefficients are rounded from long double as the compiler of the processor rounds them.
static_assert(static_cast<double>(1.0L + 0x1p-53L + 0x1p-63L) == 1 + 0x1p-52);

template <class Kind, class P>
__global__ void __launch_bounds__(P::threads) run_blocks(const P program) {
  extern __shared__ double shared[];
  run_block(Kind{}, CudaBlock{}, program, static_cast<std::int32_t>(blockIdx.x), shared);
}

/// Calls f(kernel, program) with the kernel of the program.
template <class F>
void with_kernel(const DeviceProgram& program, const F& f) {
  program.visit(
      [&]<class P>(const P& own) { with_kind(own, [&]<class Kind>(Kind) { f(run_blocks<Kind, P>, own); }); });
}

/// Programs as a graph.
struct ProgramGraph {
  std::vector<DeviceProgram> of;
  LoadEvaluations loads;
  cudaGraphExec_t graph = nullptr;

  ProgramGraph() = default;
  ProgramGraph(ProgramGraph&& other) noexcept { *this = std::move(other); }
  ProgramGraph& operator=(ProgramGraph&& other) noexcept {
    std::swap(of, other.of);
    std::swap(loads, other.loads);
    std::swap(graph, other.graph);
    return *this;
  }
  ~ProgramGraph() {
    if (graph) cudaGraphExecDestroy(graph);
  }
};

__global__ void count_evaluations(std::int64_t* evaluated, std::int64_t more) { *evaluated += more; }

/// Freed at its end; errors come with the next call.
struct FreeMemory {
  void operator()(void* memory) const { cudaFree(memory); }
};

class Gpu final : public Device {
 public:
  Gpu() {
    int cards = 0;
    if (cudaGetDeviceCount(&cards) != cudaSuccess || cards == 0)
      throw InputError("there is no GPU that CUDA can use; see nvidia-smi, or leave out --device");
    check(cudaGetDeviceProperties(&card_, 0), "is not known");
    check(cudaStreamCreate(&stream_), "cannot be used");
    check(cudaEventCreate(&begin_), "cannot be used");
    check(cudaEventCreate(&end_), "cannot be used");
  }
  ~Gpu() override {
    cudaEventDestroy(begin_);
    cudaEventDestroy(end_);
    cudaStreamDestroy(stream_);
  }

  [[nodiscard]] DeviceFacts facts() const override {
    int driver = 0, runtime = 0, khz = 0, memory_khz = 0, ratio = 0;
    check(cudaDriverGetVersion(&driver), "has no driver");
    check(cudaRuntimeGetVersion(&runtime), "has no run time");
    check(cudaDeviceGetAttribute(&khz, cudaDevAttrClockRate, 0), "does not tell its clock");
    check(cudaDeviceGetAttribute(&memory_khz, cudaDevAttrMemoryClockRate, 0),
          "does not tell its memory clock");
    check(cudaDeviceGetAttribute(&ratio, cudaDevAttrSingleToDoublePrecisionPerfRatio, 0),
          "does not tell its speed");
    // 128 single-precision units in a multiprocessor; 64 in those of 6.0, 7 and 8.0.
    const int kind = card_.major * 10 + card_.minor;
    const double units = kind == 60 || card_.major == 7 || kind == 80 ? 64 : 128;
    return {.name = card_.name,
            .clock_mhz = khz / 1e3,
            .driver = "CUDA " + version(driver) + ", run time " + version(runtime),
            .flops = card_.multiProcessorCount * units / ratio * khz * 1e3,
            .single_flops = card_.multiProcessorCount * units * khz * 1e3,
            .bytes = 2.0 * memory_khz * 1e3 * card_.memoryBusWidth / 8,
            .shared_memory = card_.sharedMemPerBlockOptin};
  }

  [[nodiscard]] void* allocate(std::size_t bytes) override {
    void* memory = nullptr;
    check(cudaMalloc(&memory, bytes), "has too little memory");
    memory_.emplace_back(memory);
    return memory;
  }
  void release(void* memory) override {
    std::erase_if(memory_, [&](const auto& each) { return each.get() == memory; });
  }
  void write(void* to, const void* from, std::size_t bytes) override {
    move(to, from, bytes, cudaMemcpyHostToDevice);
  }
  void read(void* to, const void* from, std::size_t bytes) override {
    move(to, from, bytes, cudaMemcpyDeviceToHost);
  }
  void copy(void* to, const void* from, std::size_t bytes) override {
    move(to, from, bytes, cudaMemcpyDeviceToDevice);
  }

  void run(std::span<const DeviceProgram> programs, std::int64_t times, LoadEvaluations loads) override {
    for (const DeviceProgram& program : programs) make_room(program);
    const auto of_graph =
        static_cast<std::int64_t>(std::max<std::size_t>(1, launches_of_a_graph / programs.size()));
    // Programs that are never the same again, as those of chosen steps, are worth no graph.
    const bool repeats =
        (programs.size() > 1 || times > 1) &&
        std::all_of(programs.begin(), programs.end(), [](const auto& own) { return own.is(own); });
    const cudaGraphExec_t graph =
        repeats && times >= of_graph ? graph_of(programs, of_graph, loads) : nullptr;
    timed([&] {
      for (; graph && times >= of_graph; times -= of_graph)
        check(cudaGraphLaunch(graph, stream_), "does not step");
      launch(programs, times, loads);
    });
  }

  [[nodiscard]] double seconds() override { return std::exchange(milliseconds_, 0.0) / 1e3; }

 private:
  static std::string version(int number) {
    return std::to_string(number / 1000) + "." + std::to_string(number % 1000 / 10);
  }

  void move(void* to, const void* from, std::size_t bytes, cudaMemcpyKind kind) {
    check(cudaMemcpyAsync(to, from, bytes, kind, stream_), "does not copy");
    check(cudaStreamSynchronize(stream_), "does not copy");
  }

  static void make_room(const DeviceProgram& program) {
    with_kernel(program, [](auto kernel, const auto& own) {
      const std::size_t bytes = shared_bytes_of(own);
      if (bytes > shared_by_default)
        check(cudaFuncSetAttribute(kernel, cudaFuncAttributeMaxDynamicSharedMemorySize,
                                   static_cast<int>(bytes)),
              "has too little shared memory");
    });
  }

  void launch(std::span<const DeviceProgram> programs, std::int64_t times, LoadEvaluations loads) {
    std::int32_t before = 0;
    for (std::int64_t n = 0; n < times; ++n, before += loads.each)
      for (const DeviceProgram& program : programs)
        with_kernel(program.later(before), [&]<class P>(auto kernel, const P& own) {
          kernel<<<static_cast<unsigned>(blocks_of(own)), P::threads, shared_bytes_of(own), stream_>>>(own);
        });
    if (before > 0) count_evaluations<<<1, 1, 0, stream_>>>(loads.before, before);
  }

  /// The graph of these programs, one of those that are kept where it is there. A run of long steps has up to
  /// three: of two steps, there and back, of an odd one and of the last one; frames of one step have two.
  cudaGraphExec_t graph_of(std::span<const DeviceProgram> programs, std::int64_t times,
                           LoadEvaluations loads) {
    const auto is_it = [&](const ProgramGraph& each) {
      return each.graph && each.loads == loads &&
             std::equal(programs.begin(), programs.end(), each.of.begin(), each.of.end(),
                        [](const auto& own, const auto& its) { return own.is(its); });
    };
    const auto found = std::find_if(graphs_.begin(), graphs_.end(), is_it);
    const auto taken = found == graphs_.end() ? found - 1 : found;  // else in the place of the oldest
    std::rotate(graphs_.begin(), taken, taken + 1);
    ProgramGraph& kept = graphs_[0];
    if (found != graphs_.end()) return kept.graph;
    if (kept.graph) cudaGraphExecDestroy(std::exchange(kept.graph, nullptr));
    cudaGraph_t graph = nullptr;
    check(cudaStreamBeginCapture(stream_, cudaStreamCaptureModeThreadLocal), "makes no graph");
    launch(programs, times, loads);
    check(cudaStreamEndCapture(stream_, &graph), "makes no graph");
    const cudaError_t made = cudaGraphInstantiate(&kept.graph, graph, 0);
    cudaGraphDestroy(graph);
    check(made, "makes no graph");
    kept.of.assign(programs.begin(), programs.end());
    kept.loads = loads;
    return kept.graph;
  }

  template <class Work>
  void timed(const Work& work) {
    check(cudaEventRecord(begin_, stream_), "does not step");
    work();
    check(cudaGetLastError(), "does not step");
    check(cudaEventRecord(end_, stream_), "does not step");
    check(cudaEventSynchronize(end_), "does not step");
    float milliseconds = 0;
    check(cudaEventElapsedTime(&milliseconds, begin_, end_), "tells no times");
    milliseconds_ += milliseconds;
  }

  cudaDeviceProp card_{};
  cudaStream_t stream_ = nullptr;
  cudaEvent_t begin_ = nullptr, end_ = nullptr;
  std::array<ProgramGraph, 4> graphs_;
  std::vector<std::unique_ptr<void, FreeMemory>> memory_;
  double milliseconds_ = 0;
};

}  // namespace
}  // namespace hmax

// NOLINTNEXTLINE(readability-identifier-naming): found by its name
extern "C" __attribute__((visibility("default"))) std::unique_ptr<hmax::Device> hmax_make_device() {
  return std::make_unique<hmax::Gpu>();
}
