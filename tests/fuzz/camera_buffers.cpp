// SPDX-License-Identifier: Apache-2.0
// Arbitrary camera data: formats, sizes, paddings, frame numbers and stamps.
#include <limits>
#include <optional>
#include <vector>

#include "fovea/camera/frame_counter.hpp"
#include "fovea/camera/latch_mapper.hpp"
#include "fovea/camera/raw_picture.hpp"
#include "fovea/camera/stamp.hpp"
#include "fovea/camera/stamp_mapper.hpp"
#include "fovea/hal/types.hpp"
#include "tests/fuzz/bytes.hpp"
#include "tests/fuzz/fuzz.hpp"

using fovea::fuzz::Require;
using namespace fovea;

namespace {

std::uint64_t Long(fuzz::Bytes& input) {
  // Often a 32-bit value, sometimes any 64-bit value.
  const std::uint8_t how = input.Byte();
  const std::uint64_t value = how % 4 == 0 ? std::uint64_t{input.Word()} << 32U | input.Word() : input.Word();
  return how % 8 == 1 ? ~value : value;
}

int Size(fuzz::Bytes& input) {
  const std::uint8_t how = input.Byte();
  return how % 4 == 0 ? static_cast<int>(input.Word()) : how % 67 - 1;
}

void TakePicture(fuzz::Bytes& input) {
  const auto format = static_cast<camera::RawFormat>(input.Byte() % 8U);
  const int width_px = Size(input);
  const int height_px = Size(input);
  const int padding = Size(input);
  const std::span<const std::uint8_t> given = input.Take(std::size_t{256} * input.Byte());
  // Copied, so that AddressSanitizer detects a read past the end.
  const std::vector<std::uint8_t> bytes(given.begin(), given.end());
  camera::RawPicture raw{format, width_px, height_px, 0, bytes};
  cv::Mat out;
  if (!camera::SetPadding(padding, raw)) {
    return;
  }
  Require(raw.stride_bytes >= width_px, "a row holds its pixels");
  if (camera::Unpack(raw, out)) {
    Require(out.cols == width_px && out.rows == height_px, "a picture has its declared size");
    const hal::Frame frame = camera::FrameOf(out);
    Require(frame.pixels.size() >= static_cast<std::size_t>(frame.stride_bytes) *
                                       (static_cast<std::size_t>(frame.height_px) - 1U),
            "a frame's buffer holds all its pixels");
  }
}

void TakeStamps(fuzz::Bytes& input) {
  camera::StampMapper stamps(static_cast<std::int64_t>(input.Word()));
  camera::LatchMapper latches;
  camera::FrameCounter numbers(1, input.Byte() % 2 == 0 ? 0 : 65535);
  std::int64_t now_ns = input.Word();
  std::int64_t last_ns = std::numeric_limits<std::int64_t>::min();
  std::optional<std::int64_t> last_reading_ns;
  std::uint64_t last_number = 0;
  for (bool first = true; !input.empty(); first = false) {
    const auto device_ns = static_cast<std::int64_t>(Long(input));
    now_ns += input.Word();
    const std::int64_t host_ns = stamps.Map(device_ns, now_ns);
    Require(host_ns > last_ns, "stamps increase");
    last_ns = host_ns;
    const auto ticks = static_cast<std::int64_t>(Long(input));
    const std::uint8_t trip = input.Byte();
    const double ns_per_tick = trip % 4 == 0 ? 1e9 / (1.0 + trip) : 1.0;
    if (const auto reading_ns = camera::StampOfTicks(ticks, ns_per_tick)) {
      Require(camera::IsStamp(*reading_ns), "a converted stamp is in range");
      latches.Add(now_ns - trip * 1000, *reading_ns, now_ns);
      last_reading_ns = reading_ns;
    }
    const bool is_known = latches.Map(device_ns).has_value();
    const bool may_be = camera::IsStamp(device_ns) && last_reading_ns;
    Require(!is_known || (may_be && device_ns - *last_reading_ns <= 10 * hal::kNsPerSecond),
            "a clock reading is used for at most ten seconds");
    Require(is_known || !may_be || device_ns - *last_reading_ns > 2 * hal::kNsPerSecond,
            "a recent clock reading gives a host time");
    const std::uint64_t number = numbers.Count(Long(input));
    Require(first || number > last_number, "frame numbers increase");
    last_number = number;
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Bytes input(data, size);
  if (input.Byte() % 2 == 0) {
    TakePicture(input);
  } else {
    TakeStamps(input);
  }
  return 0;
}
