// Frames on a serial line. PROTOCOL.md in firmware/core/link has the whole of it.
//
//   0x00 | COBS(version u8, kind u8, sequence u32, payload, crc u32) | 0x00
//
// Consistent overhead byte stuffing leaves no 0 within a frame, so that a reader finds the next one after
// whatever was lost. Numbers are little-endian; the CRC-32 is over all that stands before it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace fovea::link {

inline constexpr std::uint8_t kProtocolVersion = 5;
inline constexpr std::size_t kMaxPayload = 4096;
inline constexpr std::size_t kFrameOverhead = 10;  // version, kind, sequence, CRC
inline constexpr std::size_t kMaxFrame = kMaxPayload + kFrameOverhead;
// On the line: one more byte for each 254, one at the start, and the two zeros around it.
inline constexpr std::size_t kMaxEncoded = kMaxFrame + kMaxFrame / 254 + 4;

enum class FrameKind : std::uint8_t {
  kHello = 1,      // servo: I am ready to be configured
  kConfigure = 2,  // host: this is what you shall do
  kAnswer = 3,     // servo: taken, or why not
  kInputs = 4,     // host: what the arm and the camera say
  kOutputs = 5,    // servo: what a tick made of it
  kCrash = 6,      // servo: the processor faulted; the outputs are safe and stay so
  kProvoke = 7,    // host: do something forbidden, to see it end well; taken only when so configured
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
  // The bytes for the line, until the next call; none when the payload is longer than kMaxPayload.
  [[nodiscard]] std::span<const std::uint8_t> Encode(const Frame& frame) noexcept;

 private:
  void Put(std::uint8_t byte) noexcept;
  void CloseRun() noexcept;

  std::array<std::uint8_t, kMaxEncoded> bytes_{};
  std::size_t size_ = 0;
  std::size_t code_at_ = 0;  // where the length of the run in hand will stand
};

struct ReaderCounters {
  std::uint32_t frames = 0;
  std::uint32_t damaged = 0;  // CRC wrong, broken stuffing, too short or too long
  std::uint32_t unknown = 0;  // of another version, or of no known kind
  bool operator==(const ReaderCounters&) const = default;
};

// Finds frames in a stream of bytes; what is no frame is counted and left out. Real-time: yes.
class FrameReader {
 public:
  // True when `byte` was the last of a frame: frame() has it, until the next call.
  [[nodiscard]] bool Add(std::uint8_t byte) noexcept;
  [[nodiscard]] const Frame& frame() const noexcept { return frame_; }
  [[nodiscard]] const ReaderCounters& counters() const noexcept { return counters_; }

 private:
  bool Finish() noexcept;
  void Store(std::uint8_t byte) noexcept;

  std::array<std::uint8_t, kMaxFrame> bytes_{};
  std::size_t size_ = 0;
  std::uint8_t run_left_ = 0;    // bytes until the next code
  bool zero_after_run_ = false;  // the run in hand stands for one more 0
  bool any_ = false;             // something came since the last 0
  bool bad_ = false;             // too long: nothing counts before the next 0
  Frame frame_;
  ReaderCounters counters_;
};

}  // namespace fovea::link
