// SPDX-License-Identifier: Apache-2.0
// What a call across the seam can answer. Plain data: no heap, no exception, safe in the tick.
#pragma once

#include <cstdint>

namespace fovea::hal {

// Each driver maps its own errors onto these; hal/README.md says what the caller does about each.
enum class StatusCode : std::uint8_t {
  kOk = 0,
  kTimeout,          // nothing arrived within the time allowed; try again
  kClosed,           // the device was closed on purpose; no data will follow
  kDisconnected,     // the device is gone; no data will follow unless it is opened again
  kDeviceFault,      // the device reports a fault of its own (reflex, user stop); it has stopped by itself
  kInvalidArgument,  // the caller passed something that this device cannot take; nothing was done
  kNonFinite,        // the caller passed a value that is not finite; nothing was done
  kOutOfRange,       // the caller passed a value outside the stated range; nothing was done
};

// A sentence fragment for a person; static storage.
const char* ToString(StatusCode code) noexcept;

class [[nodiscard]] Status {
 public:
  constexpr Status() noexcept = default;
  // `where` names the key, field or device that the code is about; it must have static storage.
  explicit constexpr Status(StatusCode code, const char* where = "") noexcept : code_(code), where_(where) {}

  static constexpr Status Ok() noexcept { return Status(); }
  [[nodiscard]] constexpr bool ok() const noexcept { return code_ == StatusCode::kOk; }
  [[nodiscard]] constexpr StatusCode code() const noexcept { return code_; }
  [[nodiscard]] constexpr const char* where() const noexcept { return where_; }

 private:
  StatusCode code_ = StatusCode::kOk;
  const char* where_ = "";
};

}  // namespace fovea::hal
