// SPDX-License-Identifier: Apache-2.0
// A rolling shutter in the closed loop, with the servo's correction and without.
#include <string>
#include <vector>

#include "tests/closed_loop/closed_loop.hpp"

namespace fovea::test {
namespace {

sim::Summary MovingSquare(const std::string& shutter) {
  return RunShipped("square", {"target.motion=circle", "target.path_radius=0.05", "target.speed=0.1",
                               "run.duration_s=8", shutter});
}

// A plate's four corners are exposed at different times. Rows of 60 us take 29 ms for a picture.
TEST(RollingShutter, OfAMovingSquareIsCorrectedByTheServoThatKnowsIt) {
  const sim::Summary known = MovingSquare("camera.row_time_us=60");
  const sim::Summary unknown = MovingSquare("truth.camera.row_time_us=60");
  PrintResidual(known);
  PrintResidual(unknown);
  std::cout << "misfit of the views " << known.beliefs->misfit << ", without the correction "
            << unknown.beliefs->misfit << '\n';
  EXPECT_TRUE(known.converged);
  EXPECT_LE(known.tracking_error_px_rms.value(), 3.0);
  ExpectSound(known);
  EXPECT_TRUE(known.beliefs->DoViewsFit());
  EXPECT_FALSE(unknown.beliefs->DoViewsFit()) << "without the correction the corners fit no pose";
  ExpectSound(unknown);
}

TEST(RollingShutter, OfACheapCameraIsBorne) {
  const sim::Summary s = RunShipped("ball-shutter");
  PrintResidual(s);
  EXPECT_TRUE(s.converged);
  EXPECT_LE(s.tracking_error_px_rms.value(), 1.5);
  ExpectSound(s);
}

}  // namespace
}  // namespace fovea::test
