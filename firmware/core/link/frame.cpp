// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/link/frame.hpp"

#include "firmware/core/link/crc32.hpp"

namespace fovea::link {
namespace {

constexpr std::uint8_t kLongestRun = 0xff;  // the code of 254 bytes without a 0 that no 0 follows

std::array<std::uint8_t, 4> ToBytes(std::uint32_t value) noexcept {
  return {static_cast<std::uint8_t>(value), static_cast<std::uint8_t>(value >> 8U),
          static_cast<std::uint8_t>(value >> 16U), static_cast<std::uint8_t>(value >> 24U)};
}

std::uint32_t FromBytes(const std::uint8_t* bytes) noexcept {
  return static_cast<std::uint32_t>(bytes[0]) | static_cast<std::uint32_t>(bytes[1]) << 8U |
         static_cast<std::uint32_t>(bytes[2]) << 16U | static_cast<std::uint32_t>(bytes[3]) << 24U;
}

bool IsKnown(std::uint8_t kind) noexcept {
  return kind >= static_cast<std::uint8_t>(FrameKind::kHello) &&
         kind <= static_cast<std::uint8_t>(FrameKind::kGo);
}

}  // namespace

void FrameWriter::CloseRun() noexcept {
  bytes_[code_at_] = static_cast<std::uint8_t>(size_ - code_at_);
  code_at_ = size_++;
}

void FrameWriter::Put(std::uint8_t byte) noexcept {
  if (byte != 0) {
    bytes_[size_++] = byte;
  }
  if (byte == 0 || size_ - code_at_ == kLongestRun) {
    CloseRun();
  }
}

std::span<const std::uint8_t> FrameWriter::Encode(const Frame& frame) noexcept {
  if (frame.payload.size() > kMaxPayload) {
    return {};
  }
  size_ = 0;
  bytes_[size_++] = 0;
  code_at_ = size_++;
  const std::array<std::uint8_t, 4> sequence = ToBytes(frame.sequence);
  const std::array<std::uint8_t, 6> head{kProtocolVersion, static_cast<std::uint8_t>(frame.kind),
                                         sequence[0],      sequence[1],
                                         sequence[2],      sequence[3]};
  const std::uint32_t crc = Crc32(frame.payload, Crc32(head));
  for (const std::uint8_t byte : head) {
    Put(byte);
  }
  for (const std::uint8_t byte : frame.payload) {
    Put(byte);
  }
  for (const std::uint8_t byte : ToBytes(crc)) {
    Put(byte);
  }
  bytes_[code_at_] = static_cast<std::uint8_t>(size_ - code_at_);
  bytes_[size_++] = 0;
  return {bytes_.data(), size_};
}

void FrameReader::Store(std::uint8_t byte) noexcept {
  if (size_ == bytes_.size()) {
    bad_ = true;
    return;
  }
  bytes_[size_++] = byte;
}

bool FrameReader::Add(std::uint8_t byte) noexcept {
  if (byte == 0) {
    const bool whole = Finish();
    size_ = 0;
    run_left_ = 0;
    zero_after_run_ = false;
    any_ = false;
    bad_ = false;
    return whole;
  }
  any_ = true;
  if (bad_) {
    return false;
  }
  if (run_left_ > 0) {
    --run_left_;
    Store(byte);
    return false;
  }
  if (zero_after_run_) {
    Store(0);
  }
  run_left_ = static_cast<std::uint8_t>(byte - 1);
  zero_after_run_ = byte != kLongestRun;
  return false;
}

bool FrameReader::Finish() noexcept {
  if (!any_) {
    return false;  // zeros between frames
  }
  if (bad_ || run_left_ > 0 || size_ < kFrameOverhead) {
    ++counters_.damaged;
    return false;
  }
  const std::size_t body = size_ - 4;
  if (Crc32({bytes_.data(), body}) != FromBytes(&bytes_[body])) {
    ++counters_.damaged;
    return false;
  }
  if (bytes_[0] != kProtocolVersion || !IsKnown(bytes_[1])) {
    ++counters_.unknown;
    return false;
  }
  ++counters_.frames;
  frame_ = {static_cast<FrameKind>(bytes_[1]), FromBytes(&bytes_[2]), {&bytes_[6], body - 6}};
  return true;
}

}  // namespace fovea::link
