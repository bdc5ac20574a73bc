// SPDX-License-Identifier: Apache-2.0
// Link frames: arbitrary bytes on the line, and arbitrary payloads written and read back.
#include <algorithm>
#include <array>

#include "firmware/core/link/frame.hpp"
#include "tests/fuzz/bytes.hpp"
#include "tests/fuzz/fuzz.hpp"

using fovea::fuzz::Require;
using namespace fovea::link;

namespace {

// A frame that the reader accepted is written and read back unchanged.
void RequireComesBack(const Frame& frame) {
  FrameWriter writer;
  FrameReader reader;
  const std::span<const std::uint8_t> line = writer.Encode(frame);
  Require(line.size() >= 2 && line.front() == 0 && line.back() == 0, "a frame is delimited by zeros");
  Require(std::count(line.begin(), line.end(), 0) == 2, "a frame contains no zero between its delimiters");
  bool whole = false;
  for (const std::uint8_t byte : line) {
    Require(!whole, "a frame is complete only at its last byte");
    whole = reader.Add(byte);
  }
  Require(whole, "a written frame is read");
  const Frame& back = reader.frame();
  Require(
      back.kind == frame.kind && back.sequence == frame.sequence &&
          std::equal(back.payload.begin(), back.payload.end(), frame.payload.begin(), frame.payload.end()),
      "a frame is unchanged after writing and reading");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  FrameReader reader;
  for (std::size_t i = 0; i < size; ++i) {
    if (reader.Add(data[i])) {
      Require(reader.frame().payload.size() <= kMaxPayload, "a payload has at most kMaxPayload bytes");
      RequireComesBack(reader.frame());
    }
  }
  fovea::fuzz::Bytes bytes(data, size);
  const auto kind = static_cast<FrameKind>(1 + bytes.Byte() % static_cast<int>(FrameKind::kGo));
  const std::uint32_t sequence = bytes.Word();
  RequireComesBack({kind, sequence, bytes.Take(kMaxPayload)});
  return 0;
}
