// SPDX-License-Identifier: Apache-2.0
// Messages: arbitrary bytes decoded as each message type. An accepted message
// encodes to the same bytes, and its values are in range.
#include <algorithm>
#include <array>

#include "firmware/core/link/frame.hpp"
#include "firmware/core/link/messages.hpp"
#include "tests/fuzz/bytes.hpp"
#include "tests/fuzz/fuzz.hpp"

using fovea::fuzz::Require;
using namespace fovea;
using namespace fovea::link;

namespace {

template <class Message>
bool TakeAndGiveBack(Bytes bytes, Message& message) {
  static std::array<std::uint8_t, kMaxPayload> storage;
  if (!Decode(bytes, message)) {
    return false;
  }
  const Bytes back = Encode(message, storage);
  Require(std::equal(back.begin(), back.end(), bytes.begin(), bytes.end()),
          "a decoded message encodes to the same bytes");
  return true;
}

void TakeInputs(Bytes bytes) {
  if (task::ServoInputs in; TakeAndGiveBack(bytes, in)) {
    Require(in.arm.num_joints >= 0 && in.arm.num_joints <= hal::kMaxJoints,
            "the number of joints is in its range");
    Require(in.feature.dim >= 0 && in.feature.dim <= hal::kMaxFeatureDim,
            "the dimension of s is in its range");
    Require(in.feature.num_poses >= 0 && in.feature.num_poses <= hal::kMaxPoses,
            "the number of poses is in its range");
    Require(static_cast<int>(in.law) < config::kNumMotionLaws, "the motion law is known");
  }
}

void TakeAnswer(Bytes bytes) {
  Answer answer;
  if (Decode(bytes, answer)) {  // `where` may be truncated, so the bytes are not compared
    Require(answer.where.back() == '\0', "the text `where` ends with a zero");
    Require(hal::ToString(answer.code) != nullptr, "a status code has a name");
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Bytes input(data, size);
  const std::uint8_t kind = input.Byte();
  const Bytes bytes = input.Rest();
  switch (kind % 6) {
    case 0: TakeInputs(bytes); break;
    case 1: {
      static Configuration configuration;
      TakeAndGiveBack(bytes, configuration);
      break;
    }
    case 2: {
      static Outputs outputs;
      TakeAndGiveBack(bytes, outputs);
      break;
    }
    case 3: TakeAnswer(bytes); break;
    case 4: {
      Crash crash;
      TakeAndGiveBack(bytes, crash);
      break;
    }
    default: {
      Provocation what{};
      TakeAndGiveBack(bytes, what);
      break;
    }
  }
  return 0;
}
