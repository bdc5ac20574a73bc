// SPDX-License-Identifier: Apache-2.0
// A serial line to a board, as a stream of bytes.
#pragma once

#include <cstdint>
#include <span>

namespace fovea::sim {

class BoardLine {
 public:
  BoardLine() = default;
  BoardLine(const BoardLine&) = delete;
  BoardLine& operator=(const BoardLine&) = delete;
  virtual ~BoardLine() = default;

  // False if the board is gone.
  virtual bool Send(std::span<const std::uint8_t> bytes) noexcept = 0;
  // Receives into `bytes` for at most `timeout_ms`. Returns the received part; empty if nothing came.
  [[nodiscard]] virtual std::span<const std::uint8_t> Receive(std::span<std::uint8_t> bytes,
                                                              int timeout_ms) noexcept = 0;
  // Whether the last Send or Receive found the board gone.
  [[nodiscard]] virtual bool gone() const noexcept = 0;
};

}  // namespace fovea::sim
