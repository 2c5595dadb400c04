/// The largest stable step of a step function written in Python, and what its steps show.
#include <array>
#include <optional>
#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include "analysis/foreign_steps/own_step.hpp"
#include "analysis/foreign_steps/settling.hpp"
#include "limits/documents/method_json.hpp"
#include "python/bindings/calls.hpp"
#include "python/bindings/groups.hpp"

namespace hmax::python {

namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// An engine behind Python functions, in this process. Its functions are called with the GIL.
///   step(y, h)     returns the next state, or None of an engine in place, whose state is then what save()
///   returns save()         all of an engine in place; else what is hidden beside the state, of any kind
///   restore(that)
class PythonStepper final : public ForeignStepper {
 public:
  struct Functions {
    py::object step, save, restore;  ///< the last two may be None
  };
  struct Facts {
    std::string name;
    bool in_place = false, single = false;
    std::vector<Index> quaternions;
    VectorXd scales;
    Eigen::SparseMatrix<double> pattern;  ///< shape (dim, dim), or empty
    std::optional<double> own_step = {};  ///< [s]
  };

  PythonStepper(Functions functions, Facts facts, VectorXd y)
      : functions_(std::move(functions)), facts_(std::move(facts)), y_(std::move(y)) {}

  [[nodiscard]] std::string name() const override { return facts_.name; }
  [[nodiscard]] Index dim() const override { return y_.size(); }
  [[nodiscard]] bool is_single_precision() const override { return facts_.single; }
  [[nodiscard]] bool has_hidden_state() const override { return has_hidden(); }
  [[nodiscard]] std::vector<Index> quaternions() const override { return facts_.quaternions; }
  [[nodiscard]] VectorXd scales() const override { return facts_.scales; }
  [[nodiscard]] Eigen::SparseMatrix<double> pattern() const override { return facts_.pattern; }
  [[nodiscard]] std::optional<double> own_step() const override { return facts_.own_step; }

  VectorXd state() override { return y_; }
  void set_state(const VectorXd& y) override {
    y_ = y;
    if (facts_.in_place) call_back([&] { called(functions_.restore, to_array(y)); });
  }
  bool step(double h, std::int64_t count) override {
    for (std::int64_t i = 0; i < count; ++i) call_back([&] { step_once(h); });
    return true;
  }
  void save(int slot) override {
    Slot& kept = slots_.at(static_cast<std::size_t>(slot));
    kept.y = y_;
    if (has_hidden()) call_back([&] { kept.hidden = called(functions_.save); });
  }
  void restore(int slot) override {
    const Slot& kept = slots_.at(static_cast<std::size_t>(slot));
    if (facts_.in_place) return set_state(kept.y);
    y_ = kept.y;
    if (has_hidden()) call_back([&] { called(functions_.restore, kept.hidden); });
  }

 private:
  struct Slot {
    VectorXd y;
    py::object hidden;
  };

  [[nodiscard]] bool has_hidden() const { return !facts_.in_place && !functions_.save.is_none(); }
  void step_once(double h) {
    const py::object next = called(functions_.step, to_array(y_), h);
    if (!facts_.in_place) {
      y_ = vector_from(next, "what step returns", dim());
      return;
    }
    if (!next.is_none())
      throw std::invalid_argument(
          "step returned a state, but returned None before; return one of them always");
    y_ = vector_from(called(functions_.save), "what save returns", dim());
  }

  Functions functions_;
  Facts facts_;
  VectorXd y_;
  std::array<Slot, 3> slots_;
};

py::object compare(const py::object& step, VectorXd y0, const std::string& name, bool single, double h0,
                   double h, const VectorXd& load) {
  PythonStepper engine({step, py::none(), py::none()},
                       {.name = name, .single = single, .quaternions = {}, .scales = {}, .pattern = {}},
                       std::move(y0));
  const ProbeSettings settings{
      .h0 = h0, .h1 = h, .watch = [](double, std::string_view) { call_back([] {}); }};
  return to_python(with_callbacks([&] { return comparison_json(compare_steps(engine, settings), load); }));
}

py::object probe(const py::object& step, const py::object& save, const py::object& restore, VectorXd y0,
                 bool in_place, const std::string& name, bool single, std::vector<Index> quaternions,
                 VectorXd scales, const Eigen::SparseMatrix<double>& pattern, double h0, double h1,
                 std::optional<double> motion, bool verify, std::optional<double> own_step) {
  PythonStepper engine({step, save, restore},
                       {.name = name,
                        .in_place = in_place,
                        .single = single,
                        .quaternions = std::move(quaternions),
                        .scales = std::move(scales),
                        .pattern = pattern,
                        .own_step = own_step},
                       std::move(y0));
  const ProbeWatch watch = [](double, std::string_view) { call_back([] {}); };
  const ProbeSettings settings{.h0 = h0, .h1 = h1, .motion = motion, .observe = verify, .watch = watch};
  return to_python(with_callbacks([&] {
    const ProbedLimit found = probe_steps(engine, settings);
    auto document = probe_json(found);
    if (const auto own = examine_own_step(engine, found, watch)) document.update(own_step_json(*own));
    return document;
  }));
}

class PythonScene final : public SettlingScene {
 public:
  PythonScene(double timestep, py::object step, py::object speed, py::object damp, py::object begin_again)
      : timestep_(timestep),
        step_(std::move(step)),
        speed_(std::move(speed)),
        damp_(std::move(damp)),
        begin_again_(std::move(begin_again)) {}

  [[nodiscard]] double timestep() const override { return timestep_; }
  void damp(double rate) override { damp_(rate); }
  bool step(double h) override { return step_(h).cast<bool>(); }
  [[nodiscard]] double speed() const override { return speed_().cast<double>(); }
  void begin_again() override { begin_again_(); }

 private:
  double timestep_;
  py::object step_, speed_, damp_, begin_again_;
};

}  // namespace

void add_probe(py::module_& module) {
  module.def("probe", &probe);
  module.def("compare", &compare);
  module.def("settle", [](double timestep, py::object step, py::object speed, py::object damp,
                          py::object begin_again) {
    PythonScene scene(timestep, std::move(step), std::move(speed), std::move(damp), std::move(begin_again));
    return in_words(settle(scene));
  });
}

}  // namespace hmax::python
