/// What needs a card: skipped by name where there is none.
#pragma once

#include <memory>

#include <gtest/gtest.h>

#include "catalogue/device/device.hpp"
#include "core/errors.hpp"

namespace hmax {

class Gpu : public testing::Test {
 protected:
  void SetUp() override {
    if (!has_gpu_module()) GTEST_SKIP() << "this build has no module for GPUs";
    try {
      device = open_gpu();
    } catch (const InputError& error) {
      GTEST_SKIP() << error.what();
    }
  }
  std::unique_ptr<Device> device;
};

}  // namespace hmax
