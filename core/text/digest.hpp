/// A short name for a long text: FNV-1a of 64 bits, as of Fowler, Noll and Vo. It tells changes apart, not
/// intruders.
#pragma once

#include <cstdint>
#include <cstdio>
#include <string>
#include <string_view>

namespace hmax {

/// FNV-1a: for each byte in order, value <- (value XOR byte) * prime modulo 2^64 [fowler2019fnv]. Equal
/// texts have equal digests on every machine; of two different texts about one pair in 2^64 has the same
/// digest.
class Digest {
 public:
  /// Appends bytes: add(a), add(b) gives the digest of a and b one after the other. Costs one
  /// multiplication a byte; no memory.
  void add(std::string_view bytes) {
    for (const char byte : bytes) value_ = (value_ ^ static_cast<unsigned char>(byte)) * 0x100000001b3;
  }

  /// 16 hexadecimal digits.
  /// The digest of what has been added so far, with leading zeros and in lower case. More may be added
  /// afterwards.
  [[nodiscard]] std::string text() const {
    char digits[17];
    std::snprintf(digits, sizeof digits, "%016llx", static_cast<unsigned long long>(value_));
    return digits;
  }

 private:
  // The offset basis of 64 bits; the multiplier in add() is the FNV prime 2^40 + 2^8 + 0xb3.
  std::uint64_t value_ = 0xcbf29ce484222325;
};

}  // namespace hmax
