/// Tests of each device; what needs a card is skipped where there is none.
#pragma once

#include <memory>

#include <gtest/gtest.h>

#include "catalogue/device/device.hpp"
#include "catalogue/device/host_device.hpp"
#include "core/errors.hpp"

namespace hmax {

/// The card. Skips the calling test where there is none, or no module for it.
inline void open_gpu_or_skip(std::unique_ptr<Device>& device) {
  if (!has_gpu_module()) GTEST_SKIP() << "this build has no module for GPUs";
  try {
    device = open_gpu();
  } catch (const InputError& error) {
    GTEST_SKIP() << error.what();
  }
}

class Gpu : public testing::Test {
 protected:
  void SetUp() override { open_gpu_or_skip(device); }
  std::unique_ptr<Device> device;
};

/// The processor, its groups of points in both orders, and the card.
enum class Where { forwards, backwards, gpu };

class EveryDevice : public testing::TestWithParam<Where> {
 protected:
  void SetUp() override {
    if (GetParam() == Where::gpu)
      open_gpu_or_skip(opened_);
    else
      opened_ = std::make_unique<HostDevice>(GetParam() == Where::backwards);
  }
  Device& device() { return *opened_; }

 private:
  std::unique_ptr<Device> opened_;
};

}  // namespace hmax
