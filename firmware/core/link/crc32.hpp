// SPDX-License-Identifier: Apache-2.0
// CRC-32 of Ethernet and zlib: reflected polynomial 0xedb88320, all ones before and after.
#pragma once

#include <cstdint>
#include <span>

namespace fovea::link {

// The CRC of `bytes`, continued from `before`; 0: nothing before. Real-time: yes.
[[nodiscard]] std::uint32_t Crc32(std::span<const std::uint8_t> bytes, std::uint32_t before = 0) noexcept;

}  // namespace fovea::link
