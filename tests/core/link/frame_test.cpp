// SPDX-License-Identifier: Apache-2.0
// Frames: round trips, their bytes on the line, and what the reader does with damaged ones.
#include "firmware/core/link/frame.hpp"

#include <gtest/gtest.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <random>
#include <string>
#include <vector>

#include "firmware/core/link/crc32.hpp"
#include "tests/support/repetitions.hpp"

namespace fovea::link {
namespace {

using ByteVector = std::vector<std::uint8_t>;

class Noise {
 public:
  explicit Noise(unsigned seed) : engine_(seed) {}
  std::size_t Below(std::size_t end) {
    return std::uniform_int_distribution<std::size_t>(0, end - 1)(engine_);
  }
  // Bytes with no zeros, few zeros or many: the cases that byte stuffing must handle.
  ByteVector Bytes(std::size_t size) {
    const std::size_t zeros = Below(4);
    ByteVector bytes(size);
    for (std::uint8_t& byte : bytes) {
      byte = static_cast<std::uint8_t>(Below(256));
      if (zeros == 0 && byte == 0) {
        byte = 1;
      } else if (zeros == 3 && Below(2) == 0) {
        byte = 0;
      }
    }
    return bytes;
  }

 private:
  std::mt19937 engine_;
};

struct Read {
  FrameKind kind;
  std::uint32_t sequence;
  ByteVector payload;
  bool operator==(const Read&) const = default;
};

std::vector<Read> ReadAll(FrameReader& reader, const ByteVector& line) {
  std::vector<Read> frames;
  for (const std::uint8_t byte : line) {
    if (reader.Add(byte)) {
      const Frame& frame = reader.frame();
      frames.push_back({frame.kind, frame.sequence, {frame.payload.begin(), frame.payload.end()}});
    }
  }
  return frames;
}

ByteVector Line(const Read& frame) {
  static FrameWriter writer;
  const auto bytes = writer.Encode({frame.kind, frame.sequence, frame.payload});
  return {bytes.begin(), bytes.end()};
}

Read RandomFrame(Noise& noise) {
  return {static_cast<FrameKind>(1 + noise.Below(8)), static_cast<std::uint32_t>(noise.Below(0xffffffff)),
          noise.Bytes(noise.Below(noise.Below(3) == 0 ? kMaxPayload + 1 : 600))};
}

TEST(Crc32, MatchesZlib) {
  const std::string check = "123456789";
  EXPECT_EQ(Crc32({reinterpret_cast<const std::uint8_t*>(check.data()), check.size()}), 0xcbf43926U);
  Noise noise(3);
  for (int k = 0; k < 200; ++k) {
    const ByteVector bytes = noise.Bytes(noise.Below(2000));
    const std::size_t cut = noise.Below(bytes.size() + 1);
    const std::span<const std::uint8_t> all(bytes);
    EXPECT_EQ(Crc32(all.subspan(cut), Crc32(all.first(cut))),
              crc32(0, bytes.data(), static_cast<uInt>(bytes.size())));
  }
}

// The bytes of the example in PROTOCOL.md.
TEST(Frame, EncodingMatchesTheProtocolPage) {
  EXPECT_EQ(Line({FrameKind::kHello, 0, {}}),
            (ByteVector{0x00, 0x03, 0x0a, 0x01, 0x01, 0x01, 0x01, 0x05, 0x75, 0xab, 0x39, 0x2d, 0x00}));
}

TEST(Frame, RoundTripIsExactAndHoldsNoZeroByte) {
  Noise noise(5);
  FrameReader reader;
  const int count = test::Repetitions(3000);
  for (int k = 0; k < count; ++k) {
    const Read frame = RandomFrame(noise);
    const ByteVector line = Line(frame);
    EXPECT_LE(line.size(), kMaxEncoded);
    EXPECT_EQ(std::count(line.begin(), line.end(), 0), 2);
    ASSERT_EQ(ReadAll(reader, line), std::vector<Read>{frame});
  }
  EXPECT_EQ(reader.counters(), (ReaderCounters{static_cast<std::uint32_t>(count), 0, 0}));
}

TEST(Frame, RoundTripIsExactAroundTheStuffingEdgeOf254Bytes) {
  FrameReader reader;
  for (std::size_t size = 240; size < 265; ++size) {
    for (const std::uint8_t last : {std::uint8_t{0}, std::uint8_t{7}}) {
      Read frame{FrameKind::kInputs, 0x01010101, ByteVector(size, 7)};
      frame.payload.push_back(last);
      ASSERT_EQ(ReadAll(reader, Line(frame)), std::vector<Read>{frame}) << size;
    }
  }
}

TEST(Frame, TooLongPayloadIsRefusedByWriterAndReader) {
  FrameWriter writer;
  const ByteVector payload(kMaxPayload + 1, 1);
  EXPECT_TRUE(writer.Encode({FrameKind::kInputs, 1, payload}).empty());
  FrameReader reader;
  ByteVector line(3 * kMaxFrame, 0x11);
  line.push_back(0);
  EXPECT_TRUE(ReadAll(reader, line).empty());
  EXPECT_EQ(reader.counters().damaged, 1U);
}

// Flipped bits, lost or doubled bytes, a lost end: no frame is invented, and the next one is read.
TEST(Frame, DamagedFrameIsDetectedAndTheNextIsRead) {
  Noise noise(11);
  FrameReader reader;
  std::uint32_t lost = 0;
  const int count = test::Repetitions(20'000);
  for (int k = 0; k < count; ++k) {
    const Read frame = RandomFrame(noise);
    const Read next = RandomFrame(noise);
    ByteVector line = Line(frame);
    const std::size_t at = noise.Below(line.size());
    switch (noise.Below(4)) {
      case 0: line[at] ^= static_cast<std::uint8_t>(1U << noise.Below(8)); break;
      case 1: line.erase(line.begin() + static_cast<std::ptrdiff_t>(at)); break;
      case 2: line.insert(line.begin() + static_cast<std::ptrdiff_t>(at), line[at]); break;
      default: line.resize(at); break;
    }
    const ByteVector after = Line(next);
    line.insert(line.end(), after.begin(), after.end());
    const std::vector<Read> read = ReadAll(reader, line);
    ASSERT_FALSE(read.empty());
    EXPECT_EQ(read.back(), next);
    EXPECT_TRUE(read.size() == 1 || (read.size() == 2 && read.front() == frame));
    lost += read.size() == 1 ? 1U : 0U;
  }
  EXPECT_GT(lost, static_cast<std::uint32_t>(0.9 * count));  // damage to a zero around a frame is harmless
  EXPECT_GE(reader.counters().damaged, lost);
}

TEST(Frame, NoiseYieldsNoFrame) {
  Noise noise(13);
  FrameReader reader;
  for (int k = 0; k < test::Repetitions(2000); ++k) {
    EXPECT_TRUE(ReadAll(reader, noise.Bytes(1000)).empty());
  }
  EXPECT_EQ(reader.counters().frames, 0U);
  EXPECT_GT(reader.counters().damaged, 0U);
}

TEST(Frame, UnknownVersionOrKindIsCounted) {
  FrameReader reader;
  Read frame{static_cast<FrameKind>(99), 1, {1, 2, 3}};
  EXPECT_TRUE(ReadAll(reader, Line(frame)).empty());
  EXPECT_EQ(reader.counters().unknown, 1U);
  const ByteVector hello_of_version_1{0x00, 0x03, 0x01, 0x01, 0x01, 0x01, 0x01,
                                      0x05, 0xb6, 0x5b, 0xfe, 0x47, 0x00};
  EXPECT_TRUE(ReadAll(reader, hello_of_version_1).empty());
  EXPECT_EQ(reader.counters().unknown, 2U);
  EXPECT_EQ(reader.counters().damaged, 0U);
}

}  // namespace
}  // namespace fovea::link
