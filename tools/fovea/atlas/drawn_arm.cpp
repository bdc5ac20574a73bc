// SPDX-License-Identifier: Apache-2.0
#include "tools/fovea/atlas/drawn_arm.hpp"

#include <algorithm>
#include <cmath>

#include "sim/robot/chain.hpp"
#include "sim/robot/sim_robot.hpp"

namespace fovea::atlas {
namespace {

using Eigen::Vector3d;
using sim::Shape;
using sim::ShapeKind;

// A part of the segment from `a` to `a + way`, as shares of it.
struct Part {
  double from = 0.0;
  double to = 1.0;

  [[nodiscard]] bool IsEmpty() const { return from > to; }
  // Keeps what is between two planes across an axis (slab method).
  void Cut(double a, double way, double half) {
    if (way == 0.0) {
      to = std::fabs(a) > half ? -1.0 : to;
      return;
    }
    const double one = (-half - a) / way;
    const double other = (half - a) / way;
    from = std::max(from, std::min(one, other));
    to = std::min(to, std::max(one, other));
  }
  // Keeps the share t for which p t^2 + 2 q t + r <= 0, with p >= 0.
  void CutQuadric(double p, double q, double r) {
    const double root2 = q * q - p * r;
    if (p == 0.0 || root2 < 0.0) {
      to = p == 0.0 && r <= 0.0 ? to : -1.0;
      return;
    }
    from = std::max(from, (-q - std::sqrt(root2)) / p);
    to = std::min(to, (-q + std::sqrt(root2)) / p);
  }
};

// Moeller and Trumbore, Fast, minimum storage ray/triangle intersection, 1997; both faces count.
bool MeetsTriangle(const Vector3d& a, const Vector3d& way, const Vector3d& v0, const Vector3d& v1,
                   const Vector3d& v2) {
  const Vector3d e1 = v1 - v0;
  const Vector3d e2 = v2 - v0;
  const Vector3d p = way.cross(e2);
  const double det = e1.dot(p);
  if (det == 0.0) {
    return false;
  }
  const Vector3d s = (a - v0) / det;
  const Vector3d q = s.cross(e1);
  const double u = s.dot(p);
  const double v = way.dot(q);
  const double t = e2.dot(q);
  return u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t >= 0.0 && t <= 1.0;
}

bool MeetsMesh(const Vector3d& a, const Vector3d& way, const sim::Mesh& mesh) {
  const auto at = [&mesh](std::size_t i) -> Vector3d {
    return mesh.vertices[mesh.indices[i]].position.cast<double>();
  };
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
    if (MeetsTriangle(a, way, at(i), at(i + 1), at(i + 2))) {
      return true;
    }
  }
  return false;
}

// Whether the segment meets the solid; both in the solid's frame.
bool Meets(const Shape& shape, const Vector3d& a, const Vector3d& way) {
  Part part;
  const double radius = shape.size.x();
  switch (shape.kind) {
    case ShapeKind::kBox:
      for (int axis = 0; axis < 3; ++axis) {
        part.Cut(a[axis], way[axis], 0.5 * shape.size[axis]);
      }
      return !part.IsEmpty();
    case ShapeKind::kCylinder: {
      const Eigen::Vector2d a2 = a.head<2>();
      const Eigen::Vector2d way2 = way.head<2>();
      part.Cut(a.z(), way.z(), 0.5 * shape.size.y());
      part.CutQuadric(way2.squaredNorm(), a2.dot(way2), a2.squaredNorm() - radius * radius);
      return !part.IsEmpty();
    }
    case ShapeKind::kSphere:
      part.CutQuadric(way.squaredNorm(), a.dot(way), a.squaredNorm() - radius * radius);
      return !part.IsEmpty();
    case ShapeKind::kMesh: return MeetsMesh(a, way, *shape.mesh);
  }
  return false;
}

double ReachOf(const Shape& shape) {
  switch (shape.kind) {
    case ShapeKind::kBox: return 0.5 * shape.size.norm();
    case ShapeKind::kCylinder: return std::hypot(shape.size.x(), 0.5 * shape.size.y());
    case ShapeKind::kSphere: return shape.size.x();
    case ShapeKind::kMesh: break;
  }
  double reach = 0.0;
  for (const sim::Vertex& vertex : shape.mesh->vertices) {
    reach = std::max(reach, static_cast<double>(vertex.position.norm()));
  }
  return reach;
}

// Distance of the origin from the segment.
double DistanceOf(const Vector3d& a, const Vector3d& way) {
  const double share = std::clamp(-a.dot(way) / way.squaredNorm(), 0.0, 1.0);
  return (a + share * way).norm();
}

}  // namespace

struct DrawnArm::Parts {
  struct Solid {
    std::size_t link;
    Shape shape;
    double reach;  // radius of a ball about the shape's origin that holds it [m]
  };
  explicit Parts(const robots::Robot& about)
      : robot(sim::LoadSimRobot(about.urdf, about.base_link, about.tip_link, about.root)), chain(robot) {}

  sim::SimRobot robot;
  sim::Chain chain;
  std::vector<Solid> solids;
};

DrawnArm::DrawnArm(const robots::Robot& about) {
  const auto parts = std::make_shared<Parts>(about);
  const sim::SimRobot& robot = parts->robot;
  std::vector<bool> is_with_camera(robot.links.size());
  for (std::size_t i = 0; i < robot.links.size(); ++i) {
    const sim::SimLink& link = robot.links[i];
    is_with_camera[i] = link.dof == robot.num_dofs - 1 ||
                        (link.parent >= 0 && is_with_camera[static_cast<std::size_t>(link.parent)]);
    if (!is_with_camera[i]) {
      for (const Shape& shape : link.visuals) {
        parts->solids.push_back({i, shape, ReachOf(shape)});
      }
    }
  }
  parts_ = parts;
}

bool DrawnArm::Hides(const model::VecN& q, const model::Vec3& p_BC,
                     const std::vector<model::Vec3>& points_B) const {
  const std::vector<Eigen::Isometry3d> X_BL = parts_->chain.LinkPoses(q);
  return std::any_of(parts_->solids.begin(), parts_->solids.end(), [&](const Parts::Solid& solid) {
    const Eigen::Isometry3d X_SB = (X_BL[solid.link] * solid.shape.X_LS).inverse();
    const Vector3d a = X_SB * p_BC;
    return std::any_of(points_B.begin(), points_B.end(), [&](const model::Vec3& p_B) {
      const Vector3d way = X_SB * p_B - a;
      return DistanceOf(a, way) <= solid.reach && Meets(solid.shape, a, way);
    });
  });
}

}  // namespace fovea::atlas
