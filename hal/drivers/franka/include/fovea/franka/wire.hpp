// SPDX-License-Identifier: Apache-2.0
// Converts plain data to the bytes of the Franka Control Interface and back: little endian, packed, with IEEE
// doubles.
//
// A message is a struct with `Fields(self, visit)`, which calls `visit` for each field in the order of the
// wire. This one list serves reading, writing and measuring a message.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <span>
#include <type_traits>

namespace fovea::franka {

static_assert(std::endian::native == std::endian::little,
              "the wire is little endian; bytes are copied as they are");
static_assert(std::numeric_limits<double>::is_iec559);

// The size of a message [bytes].
template <typename Message>
constexpr std::size_t WireSize() {
  std::size_t size = 0;
  Message message{};
  Message::Fields(message, [&size](const auto& field) { size += sizeof(field); });
  return size;
}

// Writes `message` to the start of `bytes`, which has room for WireSize<Message>(). Real-time: yes.
template <typename Message>
void Encode(const Message& message, std::span<std::byte> bytes) noexcept {
  std::byte* at = bytes.data();
  Message::Fields(message, [&at](const auto& field) {
    std::memcpy(at, &field, sizeof(field));
    at += sizeof(field);
  });
}

// Reads a message from the start of `bytes`. False, with `message` unchanged, if they are too few.
// Real-time: yes.
template <typename Message>
[[nodiscard]] bool Decode(std::span<const std::byte> bytes, Message& message) noexcept {
  if (bytes.size() < WireSize<Message>()) {
    return false;
  }
  const std::byte* at = bytes.data();
  Message::Fields(message, [&at](auto& field) {
    static_assert(std::is_trivially_copyable_v<std::remove_reference_t<decltype(field)>>);
    std::memcpy(&field, at, sizeof(field));
    at += sizeof(field);
  });
  return true;
}

// A message as an array of bytes. Real-time: yes.
template <typename Message>
[[nodiscard]] std::array<std::byte, WireSize<Message>()> Bytes(const Message& message) noexcept {
  std::array<std::byte, WireSize<Message>()> bytes;
  Encode(message, bytes);
  return bytes;
}

}  // namespace fovea::franka
