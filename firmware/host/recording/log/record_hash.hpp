// SPDX-License-Identifier: Apache-2.0
// Hashes of a run and of its arm: SHA-256 in 64 hexadecimal digits.
//
// A run's hash covers every tick's record, field by field, in little-endian bytes. Records hold virtual time
// only, so the same binary, scenario and seed give the same hash. Records do not contain measured times.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "firmware/core/model/arm_model.hpp"
#include "fovea/hal/record.hpp"

namespace fovea::log {

class RecordHash {
 public:
  RecordHash();
  ~RecordHash();
  RecordHash(const RecordHash&) = delete;
  RecordHash& operator=(const RecordHash&) = delete;

  void Add(const hal::TickRecord& record);
  // Call once, at the end.
  std::string Finish();

  struct Digest;

 private:
  std::unique_ptr<Digest> digest_;
  std::vector<std::uint8_t> bytes_;  // of one record, reused
};

// Over all numbers of the model: frames, inertias, limits.
std::string HashOfModel(const model::ArmModel& model);

}  // namespace fovea::log
