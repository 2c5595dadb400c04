/// The stepper of a plugin, in its child process.
#pragma once

#include "analysis/foreign_steps/foreign_stepper.hpp"
#include "catalogue/plugin/plugin_process.hpp"

namespace hmax {

class PluginStepper final : public ForeignStepper {
 public:
  /// @throws InputError  where the plugin is no stepper, or does not work
  explicit PluginStepper(PluginName plugin, PluginSettings settings = {});

  [[nodiscard]] std::string name() const override;
  [[nodiscard]] const std::string& note() const { return process_.facts().note; }
  [[nodiscard]] Eigen::Index dim() const override { return process_.facts().dim; }
  [[nodiscard]] bool is_single_precision() const override {
    return process_.facts().greeting.single_precision != 0;
  }
  [[nodiscard]] bool has_hidden_state() const override { return process_.facts().greeting.has_save != 0; }
  [[nodiscard]] std::vector<Eigen::Index> quaternions() const override {
    return process_.facts().quaternions;
  }
  [[nodiscard]] Eigen::VectorXd scales() const override { return process_.facts().scales; }
  [[nodiscard]] Eigen::SparseMatrix<double> pattern() const override;
  [[nodiscard]] std::optional<double> own_step() const override { return process_.facts().own_step; }
  [[nodiscard]] std::vector<ScenePart> parts() const override { return process_.facts().parts; }
  void scale_part(std::size_t part, double stiffness, double damping) override;

  Eigen::VectorXd state() override;
  void set_state(const Eigen::VectorXd& y) override;
  bool step(double h, std::int64_t count) override;
  void save(int slot) override;
  void restore(int slot) override;
  /// In one message.
  Eigen::VectorXd after(int slot, const Eigen::VectorXd& y, double h, std::int64_t count) override;
  Eigen::VectorXd advance(int slot, double h) override;

 private:
  PluginProcess process_;
};

}  // namespace hmax
