// Fingerprints, SHA-256 in 64 hexadecimal digits: of a run, and of the arm that it was computed for.
//
// A run's is taken over every tick's record, field by field, in little-endian bytes. Records hold virtual
// time only, so the same binary, scenario and seed give the same hash. Measured times are not part of them.
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
