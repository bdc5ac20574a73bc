// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/link/messages.hpp"

#include "firmware/core/link/config_fields.hpp"
#include "firmware/core/link/crc32.hpp"
#include "firmware/core/link/frame.hpp"
#include "firmware/core/link/tick_fields.hpp"

namespace fovea::link {
namespace {

template <class Fields>
Bytes Write(Storage storage, const Fields& fields) noexcept {
  FieldWriter writer(storage);
  fields(writer);
  return writer.ok() ? writer.written() : Bytes{};
}

template <class Archive, class T>
void ConfigurationFields(Archive& a, T& c) noexcept {
  a.Choice(c.pacing, kNumPacings);
  a(c.may_provoke);
  a(c.arm_crc);
  a(c.load.mass);
  Entries(a, c.load.p_ECom);
  Entries(a, c.load.I_Com_E);
  ServoFields(a, c.servo);
}

template <class Archive, class T>
void CrashFields(Archive& a, T& c) noexcept {
  a(c.exception);
  a(c.cfsr);
  a(c.hfsr);
  a(c.pc);
  a(c.lr);
}

}  // namespace

std::uint32_t ArmCrc(const model::ArmModel& arm) noexcept {
  std::array<std::uint8_t, kMaxPayload> storage;
  FieldWriter writer(storage);
  ArmFields(writer, arm);
  return Crc32(writer.written());
}

Bytes Encode(const Configuration& message, Storage storage) noexcept {
  return Write(storage, [&](FieldWriter& a) { ConfigurationFields(a, message); });
}

Bytes Encode(const Answer& message, Storage storage) noexcept {
  return Write(storage, [&](FieldWriter& a) {
    a.Choice(message.code, kNumStatusCodes);
    for (const char letter : message.where) {
      a.Choice(static_cast<std::uint8_t>(letter), 256);
    }
  });
}

Bytes Encode(const task::ServoInputs& message, Storage storage) noexcept {
  return Write(storage, [&](FieldWriter& a) {
    a.Choice(message.arm_status.code(), kNumStatusCodes);
    InputFields(a, message);
  });
}

Bytes Encode(const Outputs& message, Storage storage) noexcept {
  return Write(storage, [&](FieldWriter& a) { OutputFields(a, message); });
}

Bytes Encode(const Crash& message, Storage storage) noexcept {
  return Write(storage, [&](FieldWriter& a) { CrashFields(a, message); });
}

Bytes Encode(Provocation message, Storage storage) noexcept {
  return Write(storage, [&](FieldWriter& a) { a.Choice(message, 1); });
}

bool Decode(Bytes bytes, Configuration& message) noexcept {
  FieldReader a(bytes);
  ConfigurationFields(a, message);
  return a.Done();
}

bool Decode(Bytes bytes, Answer& message) noexcept {
  FieldReader a(bytes);
  a.Choice(message.code, kNumStatusCodes);
  for (char& letter : message.where) {
    std::uint8_t byte = 0;
    a.Choice(byte, 256);
    letter = static_cast<char>(byte);
  }
  message.where.back() = '\0';
  return a.Done();
}

bool Decode(Bytes bytes, task::ServoInputs& message) noexcept {
  FieldReader a(bytes);
  hal::StatusCode code{};
  a.Choice(code, kNumStatusCodes);
  message.arm_status = hal::Status(code, code == hal::StatusCode::kOk ? "" : "arm");
  InputFields(a, message);
  return a.Done();
}

bool Decode(Bytes bytes, Outputs& message) noexcept {
  FieldReader a(bytes);
  OutputFields(a, message);
  return a.Done();
}

bool Decode(Bytes bytes, Crash& message) noexcept {
  FieldReader a(bytes);
  CrashFields(a, message);
  return a.Done();
}

bool Decode(Bytes bytes, Provocation& message) noexcept {
  FieldReader a(bytes);
  a.Choice(message, 1);
  return a.Done();
}

}  // namespace fovea::link
