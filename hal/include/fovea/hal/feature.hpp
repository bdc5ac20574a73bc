// SPDX-License-Identifier: Apache-2.0
// What the vision task reports to the servo about one frame, and the mailbox between them.
#pragma once

#include <array>
#include <cstdint>

#include "fovea/hal/mailbox.hpp"
#include "fovea/hal/types.hpp"

namespace fovea::hal {

// What was seen, and what `s` and `cov_s` say of it; firmware/core/features has one file for each.
//
// A flat target's frame O: origin in its middle (the mean of its corners), x to the right and y down as one
// looks at its painted side, z into it; so a target that faces the camera squarely has R_CO = I.
enum class FeatureKind : std::uint8_t {
  kSphere,    // s [3] = p_CO_C / radius: the sphere's centre in camera axes, in units of its radius
  kCircle,    // s [3] = (X / Z, Y / Z, D / Z) of the disc's centre p_CO_C and its diameter D
  kSquare,    // s [8], kTriangle s [6] = (x_0, y_0, x_1, y_1, ...): the corners in the normalised image, in
  kTriangle,  // O's order, which turns from x to y; `poses` says which one may be O's first
};

// A pose of a flat target in which its outline looks as it was measured. Three corners have up to four of
// them, a square and a disc two; one image does not tell which is true, only the camera's motion does.
struct FlatPose {
  std::array<double, 3> p_CO_C{};                  // [m]
  std::array<double, 4> q_CO{1.0, 0.0, 0.0, 0.0};  // (w, x, y, z)
  std::int32_t first = 0;  // O's corner i is s's corner (first + i) modulo their number; a disc has none
};
inline constexpr int kMaxPoses = 6;

struct FeatureMeasurement {
  std::int64_t stamp_ns = 0;   // mid-exposure of the frame, monotonic, in the loop's Clock
  std::uint64_t sequence = 0;  // of the frame
  // How long the whole picture has been the same within its noise, this frame included [ns]; 0: it changed
  // since the frame before, or was not compared.
  std::int64_t same_for_ns = 0;
  FeatureKind kind = FeatureKind::kSphere;
  bool found = false;                      // false: the frame was processed and the target is not in it
  double confidence = 0.0;                 // 0 to 1; the detector rejects below its own threshold
  std::int32_t dim = 0;                    // entries of s in use
  std::array<double, kMaxFeatureDim> s{};  // [dim] units as `kind` says
  // [dim x dim] covariance of s, row-major with rows of kMaxFeatureDim entries.
  std::array<double, kMaxFeatureDim * kMaxFeatureDim> cov_s{};
  // Square and triangle: the poses that match s, the likeliest first, as starting values; 0 if none fits.
  // Circle: both poses, first the one of s, with an arbitrary turn about z; 0 if only s is known.
  std::int32_t num_poses = 0;
  std::array<FlatPose, kMaxPoses> poses{};
};

// Where a vision task puts its measurements. Real-time: yes.
class FeatureSink {
 public:
  FeatureSink(const FeatureSink&) = delete;
  FeatureSink& operator=(const FeatureSink&) = delete;
  virtual void Put(const FeatureMeasurement& measurement) noexcept = 0;

 protected:
  FeatureSink() noexcept = default;
  ~FeatureSink() = default;
};

// Hand-over from one vision thread (Put) to one servo thread (Take).
class FeatureMailbox final : public FeatureSink {
 public:
  FeatureMailbox() noexcept = default;

  // Replaces the last measurement. Cameras deliver in order; the caller of Take judges the stamp.
  void Put(const FeatureMeasurement& measurement) noexcept override;

  // True, with the newest measurement in `measurement`, when one came since the last Take; else false, and
  // `measurement` is left as it was.
  [[nodiscard]] bool Take(FeatureMeasurement& measurement) noexcept;

 private:
  Mailbox<FeatureMeasurement> box_;
};

}  // namespace fovea::hal
