// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/report/feature_path.hpp"

#include <algorithm>

#include "firmware/core/features/target_traits.hpp"
#include "firmware/core/model/rotation.hpp"
#include "firmware/host/report/envelope.hpp"

namespace fovea::report {
namespace {

constexpr std::size_t kMostPathFrames = 2000;

// Sum of the squared distances between the points of `a`, beginning at its point `first`, and of `b` [px^2].
double Apart2(const std::vector<float>& a, std::size_t first, const std::vector<float>& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < b.size(); ++i) {
    const double apart = a[(i + 2 * first) % a.size()] - b[i];
    sum += apart * apart;
  }
  return sum;
}

}  // namespace

void FeaturePath::Begin(const log::Setup& setup) {
  f_px_ = setup.f_px();
  c_u_px_ = setup.c_u_px();
  c_v_px_ = setup.c_v_px();
  const features::TargetTraits* traits = features::FindTraits(setup.target());
  const bool is_plate = traits != nullptr && traits->body == features::TargetBody::kPlate;
  model::Pose X_CO_star;
  if (setup.p_co_c_star_size() == 3) {
    X_CO_star.p = {setup.p_co_c_star(0), setup.p_co_c_star(1), setup.p_co_c_star(2)};
  }
  if (setup.q_co_star_size() == 4) {
    const auto& q = setup.q_co_star();
    static_cast<void>(model::RotationOfQuaternion({q[0], q[1], q[2], q[3]}, X_CO_star.R));
  }
  std::vector<model::Vec3> points;
  for (int i = 0; is_plate && i + 1 < setup.corners_size(); i += 2) {
    points.emplace_back(setup.corners(i), setup.corners(i + 1), 0.0);
  }
  if (points.empty()) {
    points.push_back(model::Vec3::Zero());
  }
  for (const model::Vec3& p_OP : points) {
    const model::Vec3 p_C = X_CO_star * p_OP;
    const bool is_seen = p_C.z() > 0.0;
    path_.goal_px.push_back(is_seen ? static_cast<float>(c_u_px_ + f_px_ * p_C.x() / p_C.z()) : kGap);
    path_.goal_px.push_back(is_seen ? static_cast<float>(c_v_px_ + f_px_ * p_C.y() / p_C.z()) : kGap);
  }
}

void FeaturePath::Add(const log::Feature& feature, double t_s) {
  const std::size_t size = path_.goal_px.size();
  const auto kind = static_cast<std::size_t>(feature.kind());
  std::vector<float> now(size, kGap);
  if (feature.found() && kind < features::kTargets.size()) {
    const auto put = [&](std::size_t i, double x, double y) {
      now[i] = static_cast<float>(c_u_px_ + f_px_ * x);
      now[i + 1] = static_cast<float>(c_v_px_ + f_px_ * y);
    };
    const auto& s = feature.s();
    const features::TargetBody body = features::kTargets[kind].body;
    if (body == features::TargetBody::kBall && s.size() >= 3 && s[2] > 0.0) {
      put(0, s[0] / s[2], s[1] / s[2]);
    } else if (body == features::TargetBody::kDisc && s.size() >= 3) {
      put(0, s[0], s[1]);
    } else if (body == features::TargetBody::kPlate && static_cast<std::size_t>(s.size()) == size) {
      for (std::size_t i = 0; i < size; i += 2) {
        put(i, s[static_cast<int>(i)], s[static_cast<int>(i) + 1]);
      }
      // The detector's first corner may change between frames: take the order nearest to the last frame's.
      if (!before_.empty()) {
        std::size_t nearest = 0;
        for (std::size_t first = 1; 2 * first < size; ++first) {
          nearest = Apart2(now, first, before_) < Apart2(now, nearest, before_) ? first : nearest;
        }
        std::rotate(now.begin(), now.begin() + static_cast<std::ptrdiff_t>(2 * nearest), now.end());
      }
    }
    before_ = now;
  }
  if (frames_++ % stride_ != 0) {
    return;
  }
  path_.t_s.push_back(static_cast<float>(t_s));
  path_.px.insert(path_.px.end(), now.begin(), now.end());
  if (path_.t_s.size() > kMostPathFrames) {
    Thin();
  }
}

// Keeps every second frame.
void FeaturePath::Thin() {
  const std::size_t size = path_.goal_px.size();
  const std::size_t kept = (path_.t_s.size() + 1) / 2;
  for (std::size_t i = 0; i < kept; ++i) {
    path_.t_s[i] = path_.t_s[2 * i];
    std::copy_n(path_.px.begin() + static_cast<std::ptrdiff_t>(2 * i * size), size,
                path_.px.begin() + static_cast<std::ptrdiff_t>(i * size));
  }
  path_.t_s.resize(kept);
  path_.px.resize(kept * size);
  stride_ *= 2;
}

}  // namespace fovea::report
