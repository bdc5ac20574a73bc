// SPDX-License-Identifier: Apache-2.0
#include "sim/render/cover.hpp"

namespace fovea::sim {
namespace {

constexpr float kMargin =
    0.02F;  // margin to the surface's edges [m]: smoothed edges are drawn larger than they are
constexpr float kCoverMarginPx = 2.0F;  // margin around the picture
constexpr float kBeneath = 0.03F;       // a pixel between two tiles may show the slab below the surface [m]
constexpr float kLeastDown = 0.05F;     // least downward component of a ray; a flatter ray counts as a miss

}  // namespace

Box FindBox(const Mesh& mesh) {
  Box box;
  for (const Vertex& vertex : mesh.vertices) {
    box.extend(vertex.position);
  }
  return box;
}

// All rays lie between the rays of the picture's four corners. All that is visible lies in the pyramid from
// the eye to the points where these four meet the plane.
std::optional<Box> SeenOver(const TexturedPlane& plane, const Pinhole& pinhole,
                            const Eigen::Isometry3f& X_BC) {
  const Eigen::Vector3f eye = X_BC.translation();
  const float height = eye.z() - plane.centre_B.z();
  if (height <= 0.0F) {
    return std::nullopt;
  }
  const auto f = static_cast<float>(pinhole.f_px);
  const auto c_u = static_cast<float>(pinhole.c_u_px);
  const auto c_v = static_cast<float>(pinhole.c_v_px);
  const auto right = static_cast<float>(pinhole.width_px - 1) + kCoverMarginPx;
  const auto bottom = static_cast<float>(pinhole.height_px - 1) + kCoverMarginPx;
  Box seen(eye);
  for (const float u : {-kCoverMarginPx, right}) {
    for (const float v : {-kCoverMarginPx, bottom}) {
      const Eigen::Vector3f ray =
          (X_BC.linear() * Eigen::Vector3f((u - c_u) / f, (v - c_v) / f, 1.0F)).normalized();
      if (ray.z() > -kLeastDown) {
        return std::nullopt;
      }
      const Eigen::Vector3f foot = eye - ray * (height / ray.z());
      const Eigen::Vector2f off = (foot - plane.centre_B).head<2>().cwiseAbs();
      if ((off.array() > 0.5F * plane.size.array() - kMargin).any()) {
        return std::nullopt;
      }
      seen.extend(foot);
    }
  }
  seen.min() -= Eigen::Vector3f(kMargin, kMargin, 0.0F);
  seen.max() += Eigen::Vector3f(kMargin, kMargin, kMargin);
  seen.min().z() = plane.centre_B.z() - kBeneath;
  return seen;
}

}  // namespace fovea::sim
