// SPDX-License-Identifier: Apache-2.0
// Frames on a serial line. firmware/core/link/PROTOCOL.md describes the whole protocol.
//
//   0x00 | COBS(version u8, kind u8, sequence u32, payload, crc u32) | 0x00
//
// Consistent overhead byte stuffing leaves no 0 within a frame, so that a reader finds the next frame after
// any loss. Numbers are little-endian. The CRC-32 covers everything before it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace fovea::link {

inline constexpr std::uint8_t kProtocolVersion = 10;
inline constexpr std::size_t kMaxPayload = 4096;
inline constexpr std::size_t kFrameOverhead = 10;  // version, kind, sequence, CRC
inline constexpr std::size_t kMaxFrame = kMaxPayload + kFrameOverhead;
// On the line: one more byte for each 254, one at the start, and the two zeros around it.
inline constexpr std::size_t kMaxEncoded = kMaxFrame + kMaxFrame / 254 + 4;

enum class FrameKind : std::uint8_t {
  kHello = 1,      // servo: ready to be configured
  kConfigure = 2,  // host: the configuration
  kAnswer = 3,     // servo: accepted, or the reason why not
  kInputs = 4,     // host: data of arm and camera
  kOutputs = 5,    // servo: the result of a tick
  kCrash = 6,      // servo: the processor faulted; the outputs are safe and stay so
  kProvoke = 7,    // host: do something forbidden, as a test; accepted only if so configured
  kGo = 8,         // host, of Pacing::kGated: let the timer run to its next tick
};

struct Frame {
  FrameKind kind = FrameKind::kHello;
  std::uint32_t sequence = 0;
  std::span<const std::uint8_t> payload;
};

// Encodes into its own storage. Real-time: yes.
class FrameWriter {
 public:
  // The bytes for the line, valid until the next call; none if the payload is longer than kMaxPayload.
  [[nodiscard]] std::span<const std::uint8_t> Encode(const Frame& frame) noexcept;

 private:
  void Put(std::uint8_t byte) noexcept;
  void CloseRun() noexcept;

  std::array<std::uint8_t, kMaxEncoded> bytes_{};
  std::size_t size_ = 0;
  std::size_t code_at_ = 0;  // place for the length of the current run
};

struct ReaderCounters {
  std::uint32_t frames = 0;
  std::uint32_t damaged = 0;  // CRC wrong, broken stuffing, too short or too long
  std::uint32_t unknown = 0;  // of another version or an unknown kind
  bool operator==(const ReaderCounters&) const = default;
};

// Finds frames in a stream of bytes. Counts and omits the rest. Real-time: yes.
class FrameReader {
 public:
  // True if `byte` was the last of a frame. frame() returns it until the next call.
  [[nodiscard]] bool Add(std::uint8_t byte) noexcept;
  [[nodiscard]] const Frame& frame() const noexcept { return frame_; }
  [[nodiscard]] const ReaderCounters& counters() const noexcept { return counters_; }

 private:
  bool Finish() noexcept;
  void Store(std::uint8_t byte) noexcept;

  std::array<std::uint8_t, kMaxFrame> bytes_{};
  std::size_t size_ = 0;
  std::uint8_t run_left_ = 0;    // bytes until the next code
  bool zero_after_run_ = false;  // the current run ends with a 0
  bool any_ = false;             // bytes came since the last 0
  bool bad_ = false;             // too long: nothing counts before the next 0
  Frame frame_;
  ReaderCounters counters_;
};

}  // namespace fovea::link
