// SPDX-License-Identifier: Apache-2.0
// Turns an input's bytes into the choices of a harness.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

namespace fovea::fuzz {

class Bytes {
 public:
  Bytes(const std::uint8_t* data, std::size_t size) : left_(data, size) {}

  [[nodiscard]] bool empty() const { return left_.empty(); }
  // 0 at the end of the input.
  std::uint8_t Byte() {
    const std::span<const std::uint8_t> one = Take(1);
    return one.empty() ? std::uint8_t{0} : one.front();
  }
  std::uint32_t Word() {
    std::uint32_t word = 0;
    for (const std::uint8_t byte : Take(4)) {
      word = word << 8U | byte;
    }
    return word;
  }
  // At most `size` bytes.
  std::span<const std::uint8_t> Take(std::size_t size) {
    const std::span<const std::uint8_t> taken = left_.first(std::min(size, left_.size()));
    left_ = left_.subspan(taken.size());
    return taken;
  }
  std::span<const std::uint8_t> Rest() { return Take(left_.size()); }

 private:
  std::span<const std::uint8_t> left_;
};

}  // namespace fovea::fuzz
