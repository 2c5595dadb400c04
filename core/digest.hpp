/// A short name for a long text: FNV-1a of 64 bits, as of Fowler, Noll and Vo. It tells changes apart, not intruders.
#pragma once

#include <cstdint>
#include <cstdio>
#include <string>
#include <string_view>

namespace hmax {

class Digest {
 public:
  void add(std::string_view bytes) {
    for (const char byte : bytes)
      value_ = (value_ ^ static_cast<unsigned char>(byte)) * 0x100000001b3;
  }

  /// 16 hexadecimal digits.
  [[nodiscard]] std::string text() const {
    char digits[17];
    std::snprintf(digits, sizeof digits, "%016llx", static_cast<unsigned long long>(value_));
    return digits;
  }

 private:
  std::uint64_t value_ = 0xcbf29ce484222325;
};

}  // namespace hmax
