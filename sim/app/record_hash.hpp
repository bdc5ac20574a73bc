// The fingerprint of a run: SHA-256 over every tick's record, field by field, in little-endian bytes.
//
// Records hold virtual time only, so the same binary, scenario and seed give the same hash. Measured times
// are not part of them.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "fovea/hal/record.hpp"

namespace fovea::sim {

class RecordHash {
 public:
  RecordHash();
  ~RecordHash();
  RecordHash(const RecordHash&) = delete;
  RecordHash& operator=(const RecordHash&) = delete;

  void Add(const hal::TickRecord& record);
  // 64 hexadecimal digits; call once, at the end.
  std::string Finish();

 private:
  struct Digest;
  std::unique_ptr<Digest> digest_;
  std::vector<std::uint8_t> bytes_;  // of one record, reused
};

}  // namespace fovea::sim
