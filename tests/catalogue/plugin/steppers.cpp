/// A plugin with steppers whose limits are known, and some that go wrong in the ways that plugins do.
#include <algorithm>
#include <array>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <stdexcept>
#include <string>
#include <thread>
#include <unistd.h>
#include <vector>

#include "catalogue/plugin/plugin.h"

#ifndef TESTED_VERSION
#define TESTED_VERSION HMAX_PLUGIN_VERSION
#endif

namespace {

using Numbers = std::vector<double>;

struct Engine {
  Numbers y, hidden;
  explicit Engine(Numbers start) : y(std::move(start)) {}
  virtual ~Engine() = default;
  virtual int step(double h) = 0;
  virtual int set(const double* from) { return std::copy(from, from + y.size(), y.begin()), HMAX_OK; }
};

/// x_i'' = k (x_i-1 - 2 x_i + x_i+1) between walls by symplectic Euler; h_max = 1 / (sqrt(k) sin(n pi / (2 n
/// + 2))).
template <class Real>
struct Chain : Engine {
  explicit Chain(const std::string& argument) : Engine(Numbers(2 * size_of(argument))) {}
  static std::size_t size_of(const std::string& argument) {
    return argument.empty() ? 10 : std::stoul(argument);
  }
  int step(double h) override {
    const std::size_t n = y.size() / 2;
    std::vector<Real> x(y.begin(), y.begin() + static_cast<std::ptrdiff_t>(n)),
        v(y.begin() + static_cast<std::ptrdiff_t>(n), y.end());
    const Real step = static_cast<Real>(h), k = 1e4;
    for (std::size_t i = 0; i < n; ++i)
      v[i] += step * k * ((i > 0 ? x[i - 1] : 0) - 2 * x[i] + (i + 1 < n ? x[i + 1] : 0));
    for (std::size_t i = 0; i < n; ++i) x[i] += step * v[i];
    for (std::size_t i = 0; i < n; ++i) y[i] = x[i], y[n + i] = v[i];
    return HMAX_OK;
  }
};

/// The same chain, which declares its couplings: N, or N:missing without the last one.
struct CoupledChain : Chain<double> {
  explicit CoupledChain(const std::string& argument)
      : Chain(argument.substr(0, argument.find(':'))), missing(argument.ends_with(":missing")) {}
  bool missing;
};
int couplings(void* handle, size_t* count, size_t* reach, size_t* group, size_t (*pairs)[2]);

/// A chain by RK4, whose step reaches four masses far, from a declared reach: N:REACH.
struct ReachingChain : Engine {
  explicit ReachingChain(const std::string& argument)
      : Engine(Numbers(2 * std::stoul(argument))),
        reach(std::stoul(argument.substr(argument.find(':') + 1))) {}
  std::size_t reach;
  static Numbers slope(const Numbers& y) {
    const std::size_t n = y.size() / 2;
    Numbers f(2 * n);
    for (std::size_t i = 0; i < n; ++i) {
      f[i] = y[n + i];
      f[n + i] = 1e4 * ((i > 0 ? y[i - 1] : 0) - 2 * y[i] + (i + 1 < n ? y[i + 1] : 0));
    }
    return f;
  }
  int step(double h) override {
    Numbers next = y, at = y;
    for (const auto& [ahead, weight] : {std::pair(h / 2, h / 6), {h / 2, h / 3}, {h, h / 3}, {0.0, h / 6}}) {
      const Numbers k = slope(at);
      for (std::size_t i = 0; i < y.size(); ++i) {
        next[i] += weight * k[i];
        at[i] = y[i] + ahead * k[i];
      }
    }
    y = next;
    return HMAX_OK;
  }
};

/// x'' = -2 zeta omega x' - omega^2 x by explicit Euler, omega = 10, zeta = 0.1; h_max = 2 zeta / omega =
/// 0.02.
struct ExplicitEuler : Engine {
  explicit ExplicitEuler(const std::string&) : Engine({0, 0}) {}
  int step(double h) override {
    const double x = y[0], v = y[1];
    y = {x + h * v, v + h * (-2 * v - 100 * x)};
    return HMAX_OK;
  }
};

/// Exact steps of x'' = x: unstable, and no step is to blame.
struct Unstable : Engine {
  explicit Unstable(const std::string&) : Engine({0, 0}) {}
  int step(double h) override {
    const double x = y[0], v = y[1], c = std::cosh(h), s = std::sinh(h);
    y = {c * x + s * v, s * x + c * v};
    return HMAX_OK;
  }
};

/// x'' = -x by implicit Euler: stable at every step.
struct ImplicitEuler : Engine {
  explicit ImplicitEuler(const std::string&) : Engine({0, 0}) {}
  int step(double h) override {
    const double v = (y[1] - h * y[0]) / (1 + h * h);
    y = {y[0] + h * v, v};
    return HMAX_OK;
  }
};

/// x'' = 10 - k x from x = 0 by implicit Euler, half of whose correction is made, k of an argument k=100.
/// With a = h^2 k / (1 + h^2 k) and b = 1 - a / 2 the multipliers are b +- i sqrt(b (1 - b)), and the rest is
/// at 10 (2 / k + h^2).
struct Softened : Engine {
  explicit Softened(const std::string& argument) : Engine({0, 0}), k(std::stod(argument.substr(2))) {}
  double k;
  int step(double h) override {
    const double aim = y[0] + h * y[1] + h * h * 10, x = aim - 0.5 * h * h * k * aim / (1 + h * h * k);
    y = {x, (x - y[0]) / h};
    return HMAX_OK;
  }
};

/// x' = -x and u' = -5 u by implicit Euler: nothing oscillates.
struct Decays : Engine {
  explicit Decays(const std::string&) : Engine({0, 0}) {}
  int step(double h) override {
    y = {y[0] / (1 + h), y[1] / (1 + 5 * h)};
    return HMAX_OK;
  }
};

/// x'' = -100 x - 1e4 x^3 from x = 0.2 by symplectic Euler: at rest 2 / 10, along the motion less.
struct Stiffening : Engine {
  explicit Stiffening(const std::string& argument)
      : Engine({argument.empty() ? 0.2 : std::stod(argument), 0}) {}
  int step(double h) override {
    y[1] -= h * (100 * y[0] + 1e4 * y[0] * y[0] * y[0]);
    y[0] += h * y[1];
    return HMAX_OK;
  }
};

/// u'' = -100 u - 1e4 u^3 about 0.01 + 0.2 h, cubic about zero: the state of rest depends on the step size.
struct Shifting : Engine {
  explicit Shifting(const std::string&) : Engine({0.01, 0}) {}
  int step(double h) override {
    const double off = 0.01 + 0.2 * h;
    const auto force = [](double x) { return 100 * x + 1e4 * x * x * x; };
    y[1] -= h * (force(y[0]) - force(off));
    y[0] += h * y[1];
    return HMAX_OK;
  }
};

/// Two oscillators, each of which the other holds back by as much as it moves: homogeneous, and not linear.
struct Bounded : Engine {
  explicit Bounded(const std::string&) : Engine({0, 0, 0, 0}) {}
  int step(double h) override {
    const double a = y[0], b = y[1];
    y[2] -= h * 100 * std::copysign(std::min(std::abs(a), std::abs(b)), a);
    y[3] -= h * 100 * std::copysign(std::min(std::abs(b), std::abs(a)), b);
    y[0] += h * y[2];
    y[1] += h * y[3];
    return HMAX_OK;
  }
};

/// x'' = -100 (x - 1000) in float by symplectic Euler.
struct FarFloat : Engine {
  explicit FarFloat(const std::string&) : Engine({1000, 0}) {}
  int step(double h) override {
    float x = float(y[0]), v = float(y[1]);
    v -= float(h) * 100 * (x - 1000);
    x += float(h) * v;
    y = {x, v};
    return HMAX_OK;
  }
};

using Quaternion = std::array<double, 4>;  // w, x, y, z

Quaternion product(const Quaternion& a, const Quaternion& b) {
  return {a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
          a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
          a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
          a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0]};
}

/// Rotations about a position of rest on springs with omega = 10, 20, 40 by symplectic Euler; h_max = 2 / 40.
struct Gimbal : Engine {
  explicit Gimbal(const std::string&) : Engine({0.5, 0.5, 0.5, 0.5, 0, 0, 0}) {}
  int step(double h) override {
    const Quaternion q{y[0], y[1], y[2], y[3]}, off = product({0.5, -0.5, -0.5, -0.5}, q);
    const double side = off[0] < 0 ? -1 : 1, omega[] = {10, 20, 40};
    double size = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      y[4 + i] -= h * omega[i] * omega[i] * 2 * side * off[1 + i];
      size += y[4 + i] * y[4 + i];
    }
    const double angle = h * std::sqrt(size) / 2, part = size > 0 ? std::sin(angle) / std::sqrt(size) : h / 2;
    const Quaternion next = product(q, {std::cos(angle), part * y[4], part * y[5], part * y[6]});
    std::copy(next.begin(), next.end(), y.begin());
    return HMAX_OK;
  }
};

/// Implicit Euler for x'' = -100 x by one half-hearted iteration from the last solution.
struct WarmStart : Engine {
  explicit WarmStart(const std::string&) : Engine({0, 0}) { hidden = {0}; }
  int step(double h) override {
    double& w = hidden[0];
    w += 0.3 * ((y[1] - h * 100 * y[0]) / (1 + 100 * h * h) - w);
    y[1] = w;
    y[0] += h * w;
    return HMAX_OK;
  }
};

/// Steps depend on how many there were, which nothing saves.
struct Counting : Engine {
  double count = 0;
  explicit Counting(const std::string&) : Engine({1, 0}) {}
  int step(double h) override {
    y[0] += h * 0.01 * std::sin(count++);
    return HMAX_OK;
  }
};

struct Crash : Engine {
  explicit Crash(const std::string& argument) : Engine({0, 0}), way(argument) {}
  std::string way;
  int step(double h) override {
    if (h < 0.01) return HMAX_OK;
    if (way == "talk" || way == "talk_segv") std::puts("I talk");
    if (way == "whisper") std::fputs("I whisper", stdout);
    if (way == "segv" || way == "talk_segv") raise(SIGSEGV);
    if (way == "abort") std::abort();
    if (way == "exit") std::exit(7);
    if (way == "throw") throw std::runtime_error("no scene");
    if (way == "code") return 5;
    while (way == "hang") usleep(1000);
    return HMAX_DIVERGED;
  }
};

/// A process that outlives what made it, and holds its files open. How long it sleeps is its name for a test.
void leave_a_process(bool as_daemon) {
  if (fork() != 0) return;
  if (as_daemon) setsid();
  const char* seconds = std::getenv("TESTED_SLEEP");
  execlp("sleep", "sleep", seconds != nullptr ? seconds : "60", nullptr);
  _exit(1);
}

/// x'' = -100 x by symplectic Euler, h_max = 0.2, in a library that does what a guest does not.
struct Unruly : Engine {
  explicit Unruly(const std::string& argument) : Engine({0, 0}), way(argument) {
    if (way == "child" || way == "daemon") leave_a_process(way == "daemon");
    if (way == "copy" && fork() < 0) throw std::runtime_error("no copy");
    if (way == "closes")
      for (int file = 0; file < 100; ++file) close(file);
    if (way == "deaf") {
      for (int signal = 1; signal < 32; ++signal) std::signal(signal, SIG_IGN);
      sigset_t all;
      sigfillset(&all);
      sigprocmask(SIG_SETMASK, &all, nullptr);
    }
    if (way == "elsewhere" && chdir("/") != 0) throw std::runtime_error("no other folder");
    if (way == "numbers") y.resize(10'000'000);
    if (way == "sleeps") sleep(60);
  }
  ~Unruly() override {
    if (way == "exit") std::exit(0);
    if (way == "abort") std::abort();
    if (way == "stays") sleep(60);
  }
  Unruly(const Unruly&) = delete;
  Unruly& operator=(const Unruly&) = delete;
  std::string way;
  int step(double h) override {
    y[1] -= h * 100 * y[0];
    y[0] += h * y[1];
    for (int child = 0; way == "forks" && child < 20; ++child)
      if (fork() == 0) {
        sleep(5);
        _exit(0);
      }
    if (way == "forks") usleep(2000);
    const int lines = way == "floods" ? 200'000 : way == "prints" ? 100 : 0;
    for (int line = 0; line < lines; ++line) std::printf("line %d of noise\n", line);
    return HMAX_OK;
  }
};

struct Start : Engine {
  explicit Start(const std::string& argument) : Engine({0, 0}) {
    if (argument == "nan") y[1] = std::nan("");
    if (argument == "empty") y.clear();
    if (argument == "refuse") throw std::invalid_argument("refused");
    if (argument == "crash") raise(SIGSEGV);
  }
  int step(double) override { return HMAX_OK; }
};

/// x_i'' = -k_i x_i - c_i x_i' by symplectic Euler, from numbers k_1,c_1,k_2,c_2: h_max is the least root of
/// k h^2 + 2 c h = 4. Its parts are the springs, and it asks for steps of 0.1.
struct Parted : Engine {
  explicit Parted(const std::string& argument) : Engine({}) {
    for (std::size_t at = 0; at < argument.size(); at = argument.find(',', at) + 1) {
      own.push_back(std::stod(argument.substr(at)));
      if (argument.find(',', at) == argument.npos) break;
    }
    scaled = own;
    y.resize(own.size());
  }
  Numbers own, scaled;
  int step(double h) override {
    for (std::size_t i = 0; i < y.size(); i += 2) {
      y[i + 1] -= h * (scaled[i] * y[i] + scaled[i + 1] * y[i + 1]);
      y[i] += h * y[i + 1];
    }
    return HMAX_OK;
  }
};

Engine& of(void* handle) { return *static_cast<Engine*>(handle); }

template <class E>
int create(const char* argument, void** handle) {
  *handle = new E(argument);
  return HMAX_OK;
}
void destroy(void* handle) { delete &of(handle); }
const char* error_text(void*) { return "the contact solver gave up"; }
int dimension(void* handle, size_t* n) { return *n = of(handle).y.size(), HMAX_OK; }
int get(void* handle, double* y) { return std::copy(of(handle).y.begin(), of(handle).y.end(), y), HMAX_OK; }
int set(void* handle, const double* y) { return of(handle).set(y); }
int step(void* handle, double h) { return of(handle).step(h); }
size_t saved_size(void* handle) { return sizeof(double) * (of(handle).y.size() + of(handle).hidden.size()); }
int save(void* handle, void* blob) {
  auto* to = static_cast<double*>(blob);
  to = std::copy(of(handle).y.begin(), of(handle).y.end(), to);
  return std::copy(of(handle).hidden.begin(), of(handle).hidden.end(), to), HMAX_OK;
}
int restore(void* handle, const void* blob, size_t bytes) {
  if (bytes != saved_size(handle)) return 3;
  const auto* from = static_cast<const double*>(blob);
  Engine& engine = of(handle);
  std::copy(from, from + engine.y.size(), engine.y.begin());
  std::copy(from + engine.y.size(), from + engine.y.size() + engine.hidden.size(), engine.hidden.begin());
  return HMAX_OK;
}
int first_four(void*, size_t* count, size_t* first) {
  *count = 1;
  if (first) *first = 0;
  return HMAX_OK;
}

int couplings(void* handle, size_t* count, size_t* reach, size_t* group, size_t (*pairs)[2]) {
  const std::size_t n = of(handle).y.size() / 2;
  const auto* chain = dynamic_cast<CoupledChain*>(&of(handle));
  *count = chain && chain->missing ? n - 2 : n - 1;
  if (!group) return HMAX_OK;
  if (const auto* reaching = dynamic_cast<ReachingChain*>(&of(handle))) *reach = reaching->reach;
  for (std::size_t i = 0; i < 2 * n; ++i) group[i] = i % n;
  for (std::size_t i = 0; i < *count; ++i) pairs[i][0] = i, pairs[i][1] = i + 1;
  return HMAX_OK;
}

int own_step(void*, double* h) { return *h = 0.1, HMAX_OK; }
int parts(void* handle, size_t* count, hmax_part* to) {
  static constexpr std::array<const char*, 3> names{"first", "second\tone\n", nullptr};
  const Numbers& own = dynamic_cast<Parted&>(of(handle)).own;
  *count = own.size() / 2;
  for (std::size_t i = 0; to && i < *count; ++i)
    to[i] = {"spring", i < names.size() ? names[i] : "further", own[2 * i], own[2 * i + 1]};
  return HMAX_OK;
}
int scale_part(void* handle, size_t part, double stiffness, double damping) {
  auto& engine = dynamic_cast<Parted&>(of(handle));
  engine.scaled.at(2 * part) = stiffness * engine.own[2 * part];
  engine.scaled.at(2 * part + 1) = damping * engine.own[2 * part + 1];
  return HMAX_OK;
}

template <class E>
constexpr hmax_stepper table(uint32_t flags = 0, int (*quaternions)(void*, size_t*, size_t*) = nullptr,
                             decltype(hmax_stepper::couplings) couplings = nullptr) {
  return {.object = {create<E>, destroy, error_text, dimension},
          .flags = flags,
          .get_state = get,
          .set_state = set,
          .step = step,
          .saved_size = saved_size,
          .save = save,
          .restore = restore,
          .quaternions = quaternions,
          .couplings = couplings};
}

constexpr hmax_stepper with_parts(hmax_stepper stepper, decltype(scale_part)* scales) {
  stepper.own_step = own_step;
  stepper.parts = parts;
  stepper.scale_part = scales;
  return stepper;
}

/// Writes `byte` over 64 KB of all memory that this process shares with others, from `first` on.
void scribble(int byte, std::size_t first) {
  std::ifstream maps("/proc/self/maps");
  for (std::string line; std::getline(maps, line);) {
    unsigned long begin = 0, end = 0;
    char access[5] = {};
    if (std::sscanf(line.c_str(), "%lx-%lx %4s", &begin, &end, access) == 3 && std::string(access) == "rw-s")
      std::memset(reinterpret_cast<char*>(begin) + first, byte, 65536);
  }
}
/// Goes on to write beside calls.
void scribble_on(int byte, std::size_t first) {
  std::thread([=] {
    while (true) scribble(byte, first);
  }).detach();
}

/// y' = -10 y from 1, which goes wrong at the call that the argument names: hang:500, segv:0, nan:0. Without
/// an argument it does not.
struct Faulty {
  std::string way;
  std::size_t from = 0, calls = 0;
};
int create_faulty(const char* argument, void** handle) {
  auto* faulty = new Faulty{argument};
  *handle = faulty;
  if (const std::size_t colon = faulty->way.find(':'); colon != std::string::npos) {
    faulty->from = std::stoul(faulty->way.substr(colon + 1));
    faulty->way.resize(colon);
  }
  return HMAX_OK;
}
void destroy_faulty(void* handle) { delete static_cast<Faulty*>(handle); }
int one(void*, size_t* n) { return *n = 1, HMAX_OK; }
int start_faulty(void*, double* y0, double* t_end) { return *y0 = 1, *t_end = 1, HMAX_OK; }
int rhs_faulty(void* handle, double, const double* y, double* dydt) {
  Faulty& faulty = *static_cast<Faulty*>(handle);
  *dydt = -10 * *y;
  if (faulty.calls++ < faulty.from) return HMAX_OK;
  if (faulty.way == "segv") raise(SIGSEGV);
  if (faulty.way == "kill") raise(SIGKILL);
  if (faulty.way == "exit") std::exit(7);
  if (faulty.way == "zeros" || faulty.way == "ones") {
    scribble(faulty.way == "ones" ? 0xff : 0, 0);
    pause();
  }
  if (faulty.way == "threads" && faulty.calls == faulty.from + 1) scribble_on(0xff, 192);
  if (faulty.way == "child" && faulty.calls == faulty.from + 1) leave_a_process(false);
  if (faulty.way == "slow") usleep(20'000);
  if (faulty.way == "slower") usleep(600'000);
  if (faulty.way == "nan") *dydt = std::nan("");
  if (faulty.way == "noise") *dydt *= 1 + 1e-6 * static_cast<double>(faulty.calls % 7);
  while (faulty.way == "hang") usleep(1000);
  return HMAX_OK;
}
const hmax_model faulty{
    .object = {create_faulty, destroy_faulty, nullptr, one}, .start = start_faulty, .rhs = rhs_faulty};

/// Three pendulums q'' = -sin q - 0.1 v |v|, which refuse arrays that are not aligned as plugin.h promises.
bool aligned(const double* numbers) { return reinterpret_cast<std::uintptr_t>(numbers) % 64 == 0; }
int six(void*, size_t* n) { return *n = 6, HMAX_OK; }
int start_pendulums(void*, double* y0, double* t_end) {
  for (int i = 0; i < 6; ++i) y0[i] = 0.3 * i;
  return *t_end = 1, aligned(y0) ? HMAX_OK : 9;
}
int mass_of_pendulums(void*, double* mass) { return std::fill_n(mass, 3, 1.0), aligned(mass) ? HMAX_OK : 9; }
int force_of_pendulums(void*, double, const double* q, const double* v, double* f) {
  for (int i = 0; i < 3; ++i) f[i] = -std::sin(q[i]) - 0.1 * v[i] * std::abs(v[i]);
  return aligned(q) && aligned(v) && aligned(f) ? HMAX_OK : 9;
}
constexpr hmax_model pendulums{.object = {create_faulty, destroy_faulty, nullptr, six},
                               .start = start_pendulums,
                               .mass = mass_of_pendulums,
                               .force = force_of_pendulums};

/// The same with a stiffness, right or of the other sign by the argument.
int stiffness_of_pendulums(void* handle, double, const double* q, const double*, double* K) {
  const int sign = static_cast<Faulty*>(handle)->way == "negative" ? -1 : 1;
  std::fill_n(K, 9, 0.0);
  for (int i = 0; i < 3; ++i) K[4 * i] = sign * std::cos(q[i]);
  return HMAX_OK;
}
constexpr hmax_model stiff_pendulums = [] {
  hmax_model model = pendulums;
  model.stiffness = stiffness_of_pendulums;
  return model;
}();

const hmax_stepper chain = table<Chain<double>>(), float_chain = table<Chain<float>>(HMAX_SINGLE_PRECISION),
                   explicit_euler = table<ExplicitEuler>(), unstable = table<Unstable>(),
                   implicit_euler = table<ImplicitEuler>(), softened = table<Softened>(),
                   decays = table<Decays>(), stiffening = table<Stiffening>(),
                   gimbal = table<Gimbal>(0, first_four), warm_start = table<WarmStart>(),
                   counting = table<Counting>(), crash = table<Crash>(), start = table<Start>(),
                   unruly = table<Unruly>(), coupled = table<CoupledChain>(0, nullptr, couplings),
                   reaching = table<ReachingChain>(0, nullptr, couplings), shifting = table<Shifting>(),
                   bounded = table<Bounded>(), far_float = table<FarFloat>(HMAX_SINGLE_PRECISION),
                   parted = with_parts(table<Parted>(), scale_part),
                   rigid = with_parts(table<Parted>(), nullptr);

const hmax_plugin_entry entries[]{{"chain", "masses on springs", nullptr, &chain},
                                  {"float_chain", "", nullptr, &float_chain},
                                  {"explicit_euler", "", nullptr, &explicit_euler},
                                  {"unstable", "", nullptr, &unstable},
                                  {"implicit_euler", "", nullptr, &implicit_euler},
                                  {"stiffening", "", nullptr, &stiffening},
                                  {"gimbal", "", nullptr, &gimbal},
                                  {"warm_start", "", nullptr, &warm_start},
                                  {"counting", "", nullptr, &counting},
                                  {"crash", "", nullptr, &crash},
                                  {"start", "", nullptr, &start},
                                  {"unruly", "", nullptr, &unruly},
                                  {"coupled", "", nullptr, &coupled},
                                  {"reaching", "", nullptr, &reaching},
                                  {"shifting", "", nullptr, &shifting},
                                  {"softened", "", nullptr, &softened},
                                  {"decays", "", nullptr, &decays},
                                  {"bounded", "", nullptr, &bounded},
                                  {"far_float", "", nullptr, &far_float},
                                  {"parted", "", nullptr, &parted},
                                  {"rigid", "", nullptr, &rigid},
                                  {"faulty", "", &faulty, nullptr},
                                  {"pendulums", "", &pendulums, nullptr},
                                  {"stiff_pendulums", "", &stiff_pendulums, nullptr},
                                  {"neither", "", nullptr, nullptr}};
const hmax_plugin plugin{TESTED_VERSION, sizeof entries / sizeof *entries, entries};

}  // namespace

#ifndef TESTED_NAME
#define TESTED_NAME hmax_plugin_get
#endif
HMAX_PLUGIN_EXPORT const hmax_plugin* TESTED_NAME(void) { return &plugin; }
