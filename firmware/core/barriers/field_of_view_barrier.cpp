#include "firmware/core/barriers/field_of_view_barrier.hpp"

#include <algorithm>

#include "firmware/core/features/point.hpp"

namespace fovea::barriers {
namespace {

constexpr double kRate =
    1.5;  // what is left may be used up no faster than exp(-rate t): the arm follows some ms later [1/s]

// One side of the picture: sign * (x or y) may not pass sign * bound.
struct Side {
  Eigen::Index axis;
  double sign;
  double bound;
};

}  // namespace

void LimitView(const config::ViewConfig& config, const ViewedTarget& target, MotionLimits& limits) noexcept {
  if (!config.enabled) {
    return;
  }
  const auto n = static_cast<std::size_t>(target.outline.num_points);
  std::array<features::ImagePoint, features::Polygon::kMost> points;
  std::array<double, features::Polygon::kMost> reach{};  // of the outline about each, in the image
  for (std::size_t i = 0; i < n; ++i) {
    if (!features::ComputePoint(target.seen, target.outline.p_OP[i], points[i])) {
      return;
    }
    const model::Vec3 p_C = target.seen.X_CO * target.outline.p_OP[i];
    reach[i] = target.outline.radius / p_C.z();
  }
  const Side sides[] = {{0, -1.0, config.x_min},
                        {0, 1.0, config.x_max},  //
                        {1, -1.0, config.y_min},
                        {1, 1.0, config.y_max}};
  for (const Side& side : sides) {
    const auto room = [&](std::size_t i) {
      return side.sign * (side.bound - points[i].xy[side.axis]) - reach[i];
    };
    std::size_t nearest = 0;
    for (std::size_t i = 1; i < n; ++i) {
      nearest = room(i) < room(nearest) ? i : nearest;
    }
    const features::ImagePoint& point = points[nearest];
    const double drift = side.sign * point.dxy_dt_target[side.axis];
    const model::Vec6 along = side.sign * point.L.row(side.axis).transpose();
    limits.AddRow(target.J_C.transpose().lazyProduct(along), std::max(kRate * room(nearest) - drift, 0.0));
  }
}

}  // namespace fovea::barriers
