#include "catalogue/plugin/plugin_child.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <dlfcn.h>
#include <functional>
#include <memory>
#include <new>
#include <optional>
#include <pthread.h>
#include <string>
#include <string_view>
#include <sys/prctl.h>
#include <unistd.h>
#include <vector>

#include <Eigen/Core>
#include <fmt/format.h>

#include "catalogue/plugin/plugin.h"
#include "core/text/utf8.hpp"

namespace hmax {
namespace {

/// A sentence for the user.
struct Failure {
  std::string text;
};
/// A step that cannot be done at its size.
struct Diverged {};

/// Whether this process was forked by the plugin, to which hmax does not talk.
bool is_copy = false;

/// Memory of the alignment that plugin.h promises.
class Block {
 public:
  void resize(std::size_t bytes) {
    if (bytes <= room_) return;
    memory_.reset(static_cast<std::byte*>(::operator new (bytes, std::align_val_t{64})));
    room_ = bytes;
  }
  [[nodiscard]] void* bytes() const { return memory_.get(); }
  [[nodiscard]] double* numbers() const { return static_cast<double*>(bytes()); }

 private:
  struct Free {
    void operator()(std::byte* memory) const { ::operator delete (memory, std::align_val_t{64}); }
  };
  std::unique_ptr<std::byte, Free> memory_;
  std::size_t room_ = 0;
};

struct Slot {
  Block blob;
  std::size_t bytes = 0;
  bool filled = false;
};

class Server {
 public:
  explicit Server(PluginPage& page) : page_(page), stage_(page.stage) {}

  void open(const PluginName& plugin) {
    subject_ = plugin.subject;
    find_entry(plugin);
    create(plugin);
    greet();
  }

  /// @returns false when it is over
  bool answer() {
    ++turn_;
    if (!spin_.until(page_.asked, turn_))
      while (page_.asked.load() != turn_) page_.asked.sleep_unless(turn_, std::nullopt);
    const PluginRequest request = page_.request;
    if (request.ask == PluginAsk::quit) return false;
    try {
      reply(PluginReply::Kind::done, handle(request), "");
    } catch (const Diverged&) {
      reply(PluginReply::Kind::diverged, 0, "");
    } catch (const Failure& failure) {
      reply(PluginReply::Kind::failed, 0, failure.text);
    }
    return true;
  }

  /// With the first `numbers` of out_. What the plugin has printed is written before the last reply: hmax
  /// then ends this process at once.
  void reply(PluginReply::Kind kind, std::size_t numbers, std::string_view text) {
    if (kind == PluginReply::Kind::failed) std::fflush(stdout);
    text = text.substr(0, most_plugin_characters);
    page_.reply = {.kind = kind,
                   .numbers = numbers,
                   .characters = text.size(),
                   .digest = std::hash<std::string_view>{}(text)};
    std::copy_n(out_.numbers(), numbers, page_.numbers.begin());
    std::memcpy(page_.numbers.data() + numbers, text.data(), text.size());
    page_.answered.store(turn_);
  }

  void close() {
    if (object_ && object_->destroy && created_)
      enter(PluginCall::destroy, [&] { return object_->destroy(handle_), 0; });
  }

 private:
  [[nodiscard]] std::string reason(int code) const {
    const char* text = object_ && object_->error_text ? object_->error_text(handle_) : nullptr;
    return text && *text ? std::string(text) : fmt::format("code {}", code);
  }

  template <class Call>
  int enter(PluginCall call, const Call& function) {
    stage_.calls.store(++calls_, std::memory_order_relaxed);
    stage_.call.store(call, std::memory_order_relaxed);
    try {
      const int code = function();
      if (is_copy) _exit(0);
      stage_.call.store(PluginCall::none, std::memory_order_relaxed);
      return code;
    } catch (const std::exception& error) {
      throw Failure{fmt::format("{} of {} threw an exception: {}",
                                plugin_call_names[static_cast<std::size_t>(call)], subject_, error.what())};
    }
  }

  template <class Call>
  void check(PluginCall call, const Call& function) {
    if (const int code = enter(call, function); code != HMAX_OK)
      throw Failure{fmt::format("{}() of {} failed: {}", plugin_call_names[static_cast<std::size_t>(call)],
                                subject_, reason(code))};
  }

  void find_entry(const PluginName& plugin);
  void create(const PluginName& plugin);
  void greet();
  void greet_stepper(std::vector<double>& words, PluginGreeting& greeting);
  void greet_couplings(std::vector<double>& words, PluginGreeting& greeting);
  void greet_parts(std::vector<double>& words, PluginGreeting& greeting);
  void greet_model(std::vector<double>& words, PluginGreeting& greeting);
  void greet_states(std::vector<double>& words, PluginGreeting& greeting);
  void add_name(const char* text, char end);

  std::size_t handle(const PluginRequest& request);
  std::size_t handle_model(const PluginRequest& request);
  void steps(double h, std::uint64_t count);
  void save(std::uint32_t slot);
  void restore(std::uint32_t slot);
  template <class Function>
  void differentiate(double* x, std::size_t n, const Function& f);
  /// Numbers of the request, in memory of the alignment that plugin.h promises.
  double* received(Block& into, std::size_t first, std::size_t count) const {
    into.resize(count * sizeof(double));
    std::copy_n(page_.numbers.begin() + static_cast<std::ptrdiff_t>(first), count, into.numbers());
    return into.numbers();
  }
  void set_state(const double* y) {
    check(PluginCall::set_state, [&] { return stepper_->set_state(handle_, y); });
  }
  std::size_t state() {
    out_.resize(n_ * sizeof(double));
    check(PluginCall::get_state, [&] { return stepper_->get_state(handle_, out_.numbers()); });
    return n_;
  }

  PluginPage& page_;
  PluginStage& stage_;
  std::uint32_t turn_ = 1;  ///< the greeting
  std::uint64_t calls_ = 0;
  Spin spin_;
  std::uint32_t version_ = 0;
  const hmax_plugin_entry* entry_ = nullptr;
  const hmax_object* object_ = nullptr;
  const hmax_stepper* stepper_ = nullptr;
  const hmax_model* model_ = nullptr;
  void* handle_ = nullptr;
  std::string subject_;  ///< of what it does: "the plugin"
  bool created_ = false;
  std::size_t n_ = 0;
  std::string part_names_;
  Block in_, in_velocities_, out_, ahead_, behind_;
  std::vector<Slot> slots_;
};

void Server::find_entry(const PluginName& plugin) {
  stage_.call = PluginCall::load;
  void* library = dlopen(plugin.file.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (!library) throw Failure{fmt::format("{} cannot be loaded: {}", subject_, dlerror())};
  using Get = const hmax_plugin*();
  auto* get = reinterpret_cast<Get*>(dlsym(library, "hmax_plugin_get"));
  if (!get)
    throw Failure{fmt::format("'{}' has no function hmax_plugin_get; see hmax/plugin.h",
                              plugin.file.filename().string())};
  const hmax_plugin* table = get();
  stage_.call = PluginCall::none;
  if (!table) throw Failure{fmt::format("hmax_plugin_get() of {} returned no table", subject_)};
  version_ = table->version;
  if (version_ < 1 || version_ > HMAX_PLUGIN_VERSION)
    throw Failure{fmt::format(
        "{} has version {} of hmax/plugin.h and hmax has {}; compile it with the header of this hmax",
        subject_, version_, HMAX_PLUGIN_VERSION)};
  std::string names;
  for (std::uint32_t i = 0; i < table->count && !entry_; ++i) {
    const hmax_plugin_entry& entry = table->entries[i];
    const std::string name = entry.name ? entry.name : "";
    if (plugin.name.empty() ? !entry.model != plugin.is_model : plugin.name == name) entry_ = &entry;
    names += (names.empty() ? "" : ", ") + name;
  }
  // Where all are of the other kind, who asked says so.
  if (!entry_ && plugin.name.empty() && table->count > 0) entry_ = table->entries;
  if (!entry_ && names.empty()) throw Failure{fmt::format("{} has no entries", subject_)};
  if (!entry_) throw Failure{fmt::format("{} has no entry '{}'; it has {}", subject_, plugin.name, names)};
  stepper_ = entry_->stepper;
  model_ = entry_->model;
  if (!stepper_ == !model_)
    throw Failure{fmt::format("an entry of {} must have either a model or a stepper", subject_)};
  object_ = stepper_ ? &stepper_->object : &model_->object;
  const bool complete =
      object_->create && object_->dimension &&
      (stepper_ ? stepper_->get_state && stepper_->set_state && stepper_->step
                : model_->start && (model_->force ? model_->mass != nullptr : model_->rhs != nullptr));
  if (!complete)
    throw Failure{stepper_ ? "a stepper needs create, dimension, get_state, set_state and step"
                           : "a model needs create, dimension, start, and rhs or mass and force"};
  if (stepper_ && version_ >= 3 && !stepper_->parts != !stepper_->scale_part)
    throw Failure{"a stepper has both of parts and scale_part, or none of them"};
  if (stepper_ && (!stepper_->save != !stepper_->restore || !stepper_->save != !stepper_->saved_size))
    throw Failure{"a stepper has all of saved_size, save and restore, or none of them"};
}

void Server::create(const PluginName& plugin) {
  const int code =
      enter(PluginCall::create, [&] { return object_->create(plugin.argument.c_str(), &handle_); });
  if (code != HMAX_OK)
    throw Failure{plugin.engine_file.empty() ? fmt::format("create() of {} failed: {}",
                                                           plugin.file.filename().string(), reason(code))
                                             : fmt::format("{}: {}", plugin.text, reason(code))};
  created_ = true;
  check(PluginCall::dimension, [&] { return object_->dimension(handle_, &n_); });
  if (n_ < 1 || n_ > most_plugin_states)
    throw Failure{
        fmt::format("dimension() of {} is {}; it must be 1 to {}", subject_, n_, most_plugin_states)};
  if (model_ && model_->force && n_ % 2 != 0)
    throw Failure{fmt::format("dimension() of {} is {}; with forces it is twice the number of positions",
                              subject_, n_)};
}

void Server::greet_stepper(std::vector<double>& words, PluginGreeting& greeting) {
  greeting.is_stepper = 1;
  greeting.single_precision = (stepper_->flags & HMAX_SINGLE_PRECISION) != 0;
  greeting.has_save = stepper_->save != nullptr;
  if (stepper_->quaternions) {
    std::size_t count = 0;
    check(PluginCall::quaternions, [&] { return stepper_->quaternions(handle_, &count, nullptr); });
    if (count > n_ / 4)
      throw Failure{fmt::format("{} has {} quaternions in {} numbers", subject_, count, n_)};
    std::vector<std::size_t> first(count + 1);
    const std::size_t told = count;
    check(PluginCall::quaternions, [&] { return stepper_->quaternions(handle_, &count, first.data()); });
    if (count != told) throw Failure{fmt::format("{} has {} quaternions, then {}", subject_, told, count)};
    greeting.quaternions = static_cast<double>(count);
    for (std::size_t i = 0; i < count; ++i) words.push_back(static_cast<double>(first[i]));
  }
  if (stepper_->scales) {
    greeting.has_scales = 1;
    out_.resize(n_ * sizeof(double));
    check(PluginCall::scales, [&] { return stepper_->scales(handle_, out_.numbers()); });
    words.insert(words.end(), out_.numbers(), out_.numbers() + n_);
  }
  // Earlier tables end before it.
  if (version_ >= 2 && stepper_->couplings) greet_couplings(words, greeting);
  if (version_ < 3) return;
  if (stepper_->own_step) {
    check(PluginCall::own_step, [&] { return stepper_->own_step(handle_, &greeting.own_step); });
    if (!(greeting.own_step > 0 && std::isfinite(greeting.own_step)))
      throw Failure{fmt::format("own_step() of {} is {}; it must be positive", subject_, greeting.own_step)};
  }
  if (stepper_->parts) greet_parts(words, greeting);
}

void Server::add_name(const char* text, char end) {
  std::string line = text ? text : "";
  if (line.size() > most_part_characters) {
    std::size_t whole = 0;  // characters of UTF-8
    for (std::size_t next = 0; next <= most_part_characters;
         next += std::max<std::size_t>(1, utf8_character(std::string_view(line).substr(next))))
      whole = next;
    line.resize(whole);
  }
  std::ranges::replace_if(
      line, [](char letter) { return letter == '\n' || letter == '\t'; }, ' ');
  part_names_ += line + end;
}

void Server::greet_parts(std::vector<double>& words, PluginGreeting& greeting) {
  std::size_t count = 0;
  check(PluginCall::parts, [&] { return stepper_->parts(handle_, &count, nullptr); });
  if (count > most_plugin_parts)
    throw Failure{fmt::format("{} has {} parts; it may have {}", subject_, count, most_plugin_parts)};
  std::vector<hmax_part> parts(count + 1);
  const std::size_t told = count;
  check(PluginCall::parts, [&] { return stepper_->parts(handle_, &count, parts.data()); });
  if (count != told) throw Failure{fmt::format("{} has {} parts, then {}", subject_, told, count)};
  parts.resize(count);
  greeting.parts = static_cast<double>(count);
  for (const hmax_part& part : parts) {
    words.insert(words.end(), {part.stiffness, part.damping});
    add_name(part.kind, '\t');
    add_name(part.name, '\n');
  }
}

void Server::greet_couplings(std::vector<double>& words, PluginGreeting& greeting) {
  std::size_t count = 0, reach = 1;
  check(PluginCall::couplings,
        [&] { return stepper_->couplings(handle_, &count, &reach, nullptr, nullptr); });
  if (count > most_plugin_states)
    throw Failure{fmt::format("{} has {} couplings; it may have {}", subject_, count, most_plugin_states)};
  if (reach < 1)
    throw Failure{
        fmt::format("the reach of the couplings of {} is 0; a step crosses at least one", subject_)};
  std::vector<std::size_t> group(n_);
  std::vector<std::array<std::size_t, 2>> pairs(count + 1);
  const std::size_t told = count;
  check(PluginCall::couplings, [&] {
    return stepper_->couplings(handle_, &count, &reach, group.data(),
                               reinterpret_cast<std::size_t(*)[2]>(pairs.data()));
  });
  if (count != told) throw Failure{fmt::format("{} has {} couplings, then {}", subject_, told, count)};
  pairs.resize(count);
  const auto add = [&](std::size_t of) {
    if (of >= n_)
      throw Failure{fmt::format("a group of the couplings of {} is {}; they are below {}", subject_, of, n_)};
    words.push_back(static_cast<double>(of));
  };
  greeting.has_couplings = 1;
  greeting.pairs = static_cast<double>(count);
  greeting.reach = static_cast<double>(reach);
  for (const std::size_t each : group) add(each);
  for (const auto& [one, other] : pairs) {
    add(one);
    add(other);
  }
}

/// The states of a model are its parts.
void Server::greet_states(std::vector<double>& words, PluginGreeting& greeting) {
  greeting.parts = static_cast<double>(n_);
  words.insert(words.end(), 2 * n_, 0.0);
  for (std::size_t i = 0; i < n_; ++i) {
    const char* name = nullptr;
    enter(PluginCall::state_name, [&] { return name = model_->state_name(handle_, i), HMAX_OK; });
    add_name("state", '\t');
    add_name(name, '\n');
  }
}

void Server::greet_model(std::vector<double>& words, PluginGreeting& greeting) {
  greeting.has_rhs = model_->rhs != nullptr;
  greeting.has_force = model_->force != nullptr;
  greeting.has_jacobian = model_->jacobian != nullptr;
  greeting.has_stiffness = model_->force && model_->stiffness;
  greeting.has_damping = model_->force && model_->damping;
  if (version_ >= 3 && model_->state_name && n_ <= most_plugin_parts) greet_states(words, greeting);
  out_.resize(n_ * sizeof(double));
  check(PluginCall::start, [&] { return model_->start(handle_, out_.numbers(), &greeting.t_end); });
  words.insert(words.end(), out_.numbers(), out_.numbers() + n_);
  if (model_->force) {
    check(PluginCall::mass, [&] { return model_->mass(handle_, out_.numbers()); });
    words.insert(words.end(), out_.numbers(), out_.numbers() + n_ / 2);
  }
}

void Server::greet() {
  std::vector<double> words;
  PluginGreeting greeting;
  greeting.dimension = static_cast<double>(n_);
  stepper_ ? greet_stepper(words, greeting) : greet_model(words, greeting);
  out_.resize(sizeof greeting + words.size() * sizeof(double));
  std::memcpy(out_.bytes(), &greeting, sizeof greeting);
  std::copy(words.begin(), words.end(), out_.numbers() + greeting_size);
  reply(PluginReply::Kind::done, greeting_size + words.size(),
        fmt::format("{}\n{}\n{}", entry_->name ? entry_->name : "", entry_->note ? entry_->note : "",
                    part_names_));
}

void Server::steps(double h, std::uint64_t count) {
  stage_.h = h;
  for (std::uint64_t i = 0; i < count; ++i) {
    const int code = enter(PluginCall::step, [&] { return stepper_->step(handle_, h); });
    if (code == HMAX_DIVERGED) throw Diverged{};
    if (code != HMAX_OK) throw Failure{fmt::format("step({}) of {} failed: {}", h, subject_, reason(code))};
  }
}

void Server::save(std::uint32_t slot) {
  if (slots_.size() <= slot) slots_.resize(slot + 1);
  Slot& into = slots_[slot];
  if (stepper_->save) {
    enter(PluginCall::saved_size, [&] { return into.bytes = stepper_->saved_size(handle_), 0; });
    into.blob.resize(std::max<std::size_t>(into.bytes, 1));
    check(PluginCall::save, [&] { return stepper_->save(handle_, into.blob.bytes()); });
  } else {
    into.blob.resize(n_ * sizeof(double));
    check(PluginCall::get_state, [&] { return stepper_->get_state(handle_, into.blob.numbers()); });
  }
  into.filled = true;
}

void Server::restore(std::uint32_t slot) {
  if (slot >= slots_.size() || !slots_[slot].filled)
    throw Failure{"a state that was never saved is restored"};
  const Slot& from = slots_[slot];
  if (stepper_->restore)
    check(PluginCall::restore, [&] { return stepper_->restore(handle_, from.blob.bytes(), from.bytes); });
  else
    set_state(from.blob.numbers());
}

std::size_t Server::handle(const PluginRequest& request) {
  if (model_) return handle_model(request);
  switch (request.ask) {
    case PluginAsk::state:
      return state();
    case PluginAsk::set_state:
      return set_state(received(in_, 0, n_)), 0;
    case PluginAsk::steps:
      return steps(request.h, request.count), 0;
    case PluginAsk::save:
      return save(request.slot), 0;
    case PluginAsk::restore:
      return restore(request.slot), 0;
    case PluginAsk::after:
      restore(request.slot);
      set_state(received(in_, 0, n_));
      steps(request.h, request.count);
      return state();
    case PluginAsk::advance:
      restore(request.slot);
      steps(request.h, 1);
      save(request.slot);
      return state();
    case PluginAsk::scale_part: {
      const double* factors = received(in_, 0, 2);
      check(PluginCall::scale_part, [&] {
        return stepper_->scale_part(handle_, static_cast<std::size_t>(request.count), factors[0], factors[1]);
      });
      return 0;
    }
    default:
      throw Failure{subject_ + std::string(plugin_destroyed)};
  }
}

/// d f / d x by central differences, at increments of the cube root of rounding, into out_ of n x n. f(y) is
/// of the numbers in x, which are as before at the end.
template <class Function>
void Server::differentiate(double* x, std::size_t n, const Function& f) {
  using Eigen::Map, Eigen::VectorXd;
  const auto size = static_cast<Eigen::Index>(n);
  const double least = 1e-3 * std::max(1e-3, Map<const VectorXd>(x, size).cwiseAbs().maxCoeff());
  for (Block* each : {&ahead_, &behind_}) each->resize(n * sizeof(double));
  for (std::size_t j = 0; j < n; ++j) {
    const double at = x[j], d = 6e-6 * std::max(std::abs(at), least);
    x[j] = at + d;
    f(ahead_.numbers());
    x[j] = at - d;
    f(behind_.numbers());
    x[j] = at;
    Map<VectorXd>(out_.numbers() + j * n, size) =
        (Map<const VectorXd>(ahead_.numbers(), size) - Map<const VectorXd>(behind_.numbers(), size)) /
        (2 * d);
  }
}

std::size_t Server::handle_model(const PluginRequest& request) {
  const double t = request.h;
  const bool of_rates = request.ask == PluginAsk::rhs || request.ask == PluginAsk::jacobian;
  const std::size_t m = of_rates ? n_ : n_ / 2;
  double *const y = received(in_, 0, m), *const v = received(in_velocities_, m, of_rates ? 0 : m);
  const auto force = [&](double* to) {
    check(PluginCall::force, [&] { return model_->force(handle_, t, y, v, to); });
  };
  // -d force / dx where the plugin has no function of its own.
  const auto matrix = [&](PluginCall call, const auto& given, double* x, const auto& own) {
    out_.resize(m * m * sizeof(double));
    if (given) {
      check(call, own);
    } else {
      differentiate(x, m, force);
      std::transform(out_.numbers(), out_.numbers() + m * m, out_.numbers(), std::negate());
    }
    return m * m;
  };
  out_.resize(m * sizeof(double));
  switch (request.ask) {
    case PluginAsk::rhs:
      check(PluginCall::rhs, [&] { return model_->rhs(handle_, t, y, out_.numbers()); });
      return m;
    case PluginAsk::force:
      return force(out_.numbers()), m;
    case PluginAsk::jacobian:
      out_.resize(m * m * sizeof(double));
      check(PluginCall::jacobian, [&] { return model_->jacobian(handle_, t, y, out_.numbers()); });
      return m * m;
    case PluginAsk::stiffness:
      return matrix(PluginCall::stiffness, model_->stiffness, y,
                    [&] { return model_->stiffness(handle_, t, y, v, out_.numbers()); });
    case PluginAsk::damping:
      return matrix(PluginCall::damping, model_->damping, v,
                    [&] { return model_->damping(handle_, t, y, v, out_.numbers()); });
    default:
      throw Failure{subject_ + std::string(plugin_destroyed)};
  }
}

/// Signals do what they do without hmax, the child ends with its parent, and takes care of orphans that the
/// plugin leaves.
void leave_the_parent(pid_t parent) {
  for (const int each : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGPIPE})
    std::signal(each, SIG_DFL);
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  setpgid(0, 0);
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(0);
  prctl(PR_SET_CHILD_SUBREAPER, 1);
  pthread_atfork(nullptr, nullptr, [] { is_copy = true; });
  // A plugin that calls exit() must not end hmax's files and threads, which this process has copies of.
  on_exit(
      [](int code, void*) {
        std::fflush(stdout);
        _exit(code);
      },
      nullptr);
}

}  // namespace

void serve_plugin(PluginPage& page, const PluginName& plugin, pid_t parent) {
  leave_the_parent(parent);
  Server server(page);
  try {
    server.open(plugin);
    while (server.answer()) {
    }
    server.close();
    std::fflush(stdout);
    server.reply(PluginReply::Kind::done, 0, "");
  } catch (const Failure& failure) {
    server.reply(PluginReply::Kind::failed, 0, failure.text);
  } catch (const std::bad_alloc&) {
    server.reply(PluginReply::Kind::failed, 0,
                 fmt::format("{} asked for more memory than there is", plugin.subject));
  }
  // hmax ends this process with all that the plugin has started.
  while (true) pause();
}

}  // namespace hmax
