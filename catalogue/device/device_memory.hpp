/// Memory of a device that is released with its owner.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "catalogue/device/device.hpp"

namespace hmax {

/// Released also where there is too little for all that its owner needs.
class DeviceMemory {
 public:
  /// @param device  outlives this
  explicit DeviceMemory(Device& device) : device_(device) {}
  DeviceMemory(const DeviceMemory&) = delete;
  DeviceMemory& operator=(const DeviceMemory&) = delete;
  ~DeviceMemory() {
    for (void* const place : places_) device_.release(place);
  }

  [[nodiscard]] Device& device() const { return device_; }
  /// Room for so many of T.
  template <class T>
  [[nodiscard]] T* room(std::size_t count) {
    return static_cast<T*>(
        places_.emplace_back(device_.allocate(std::max<std::size_t>(1, count) * sizeof(T))));
  }
  /// A copy of these.
  template <class T>
  [[nodiscard]] const T* copy(const std::vector<T>& values) {
    T* const to = room<T>(values.size());
    if (!values.empty()) device_.write(to, values.data(), values.size() * sizeof(T));
    return to;
  }

 private:
  Device& device_;
  std::vector<void*> places_;
};

}  // namespace hmax
