// SPDX-License-Identifier: Apache-2.0
#include "sim/render/plate_painter.hpp"

#include <cmath>
#include <numbers>

#include "sim/render/projection.hpp"
#include "sim/render/shaders.hpp"

namespace fovea::sim {
namespace {

using Eigen::Vector3f;
using Eigen::Vector4f;

constexpr int kDiscPoints = 48;
constexpr float kMarginPx = 3.0F;    // margin of the drawn rectangle
constexpr float kEdgeOnCos = 0.02F;  // a plate viewed at a flatter angle is not drawn

std::vector<Vector3f> OutlineOf(const TargetShape& shape) {
  std::vector<Vector3f> outline;
  if (shape.kind == TargetShape::Kind::kDisc) {
    for (int i = 0; i < kDiscPoints; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / kDiscPoints;
      outline.emplace_back(
          (shape.radius * Eigen::Vector3d(std::cos(angle), std::sin(angle), 0.0)).cast<float>());
    }
  }
  for (const Eigen::Vector2d& corner : shape.corners) {
    outline.emplace_back(static_cast<float>(corner.x()), static_cast<float>(corner.y()), 0.0F);
  }
  return outline;
}

// A triangle fan, visible from both sides.
Mesh MakeFan(const std::vector<Vector3f>& outline) {
  Mesh mesh;
  for (const Vector3f& p : outline) {
    mesh.vertices.push_back({p, -Vector3f::UnitZ(), Vector3f::Ones()});
  }
  for (std::uint32_t i = 2; i < outline.size(); ++i) {
    mesh.indices.insert(mesh.indices.end(), {0, i - 1, i, 0, i, i - 1});
  }
  return mesh;
}

// (x, y, 1) of the outline, which is in front of the camera.
std::vector<Vector3f> Project(const std::vector<Vector3f>& outline, const Eigen::Isometry3f& X_CO) {
  std::vector<Vector3f> seen;
  for (const Vector3f& p_O : outline) {
    const Vector3f p = X_CO * p_O;
    seen.emplace_back(p / p.z());
  }
  return seen;
}

// The lines through neighbouring corners, positive inside. The middle of the corners is inside.
std::vector<Vector3f> EdgesOf(const std::vector<Vector3f>& seen) {
  Vector3f middle = Vector3f::Zero();
  for (const Vector3f& corner : seen) {
    middle += corner;
  }
  std::vector<Vector3f> edges;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const Vector3f edge = seen[i].cross(seen[(i + 1) % seen.size()]);
    edges.emplace_back(edge / (edge.head<2>().norm() * (edge.dot(middle) < 0.0F ? -1.0F : 1.0F)));
  }
  return edges;
}

std::string Indexed(const char* name, std::size_t i) {
  return std::string(name) + "[" + std::to_string(i) + "]";
}

}  // namespace

PlatePainter::PlatePainter(const TargetShape& shape, const std::string& head)
    : shape_(shape),
      program_(head + shaders::kBallVertex,
               head + shaders::kLight + shaders::kShadow + shaders::kRows + shaders::kPlateFragment),
      outline_(OutlineOf(shape)) {
  caster_ = std::make_unique<GpuMesh>(MakeFan(outline_));
  glGenVertexArrays(1, &no_vertices_);
}

PlatePainter::~PlatePainter() { glDeleteVertexArrays(1, &no_vertices_); }

void PlatePainter::SetMotion(const PlateMotion& motion) const {
  const Eigen::Isometry3f& from = motion.X_CO_first;
  const Eigen::Isometry3f& to = motion.X_CO_last;
  program_.Set("u_normal_rate", Vector3f((to.linear().col(2) - from.linear().col(2)) / motion.rows));
  program_.Set("u_centre_rate", Vector3f((to.translation() - from.translation()) / motion.rows));
  if (shape_.kind == TargetShape::Kind::kPolygon) {
    const std::vector<Vector3f> before = EdgesOf(Project(outline_, from));
    const std::vector<Vector3f> after = EdgesOf(Project(outline_, to));
    for (std::size_t i = 0; i < before.size(); ++i) {
      program_.Set(Indexed("u_edge_rates", i).c_str(), Vector3f((after[i] - before[i]) / motion.rows));
    }
  }
}

void PlatePainter::Draw(const Eigen::Isometry3f& X_CO, const Eigen::Isometry3f& X_BC, const Pinhole& pinhole,
                        const Eigen::Matrix4f& clip_of_C, const Vector3f& colour,
                        const std::optional<PlateMotion>& motion) const {
  const Vector3f normal = X_CO.linear().col(2);
  const Vector3f centre = X_CO.translation();
  if (normal.dot(centre) < kEdgeOnCos * centre.norm()) {
    return;
  }
  const auto f_px = static_cast<float>(pinhole.f_px);
  Vector4f rectangle(1e9F, 1e9F, -1e9F, -1e9F);
  std::vector<Eigen::Isometry3f> poses{X_CO};
  if (motion) {
    poses.insert(poses.end(), {motion->X_CO_first, motion->X_CO_last});
  }
  for (const Eigen::Isometry3f& pose : poses) {
    for (const Vector3f& p_O : outline_) {
      if ((pose * p_O).z() < 2.0F * kNear) {
        return;
      }
    }
    for (const Vector3f& seen : Project(outline_, pose)) {
      rectangle.head<2>() = rectangle.head<2>().cwiseMin(seen.head<2>());
      rectangle.tail<2>() = rectangle.tail<2>().cwiseMax(seen.head<2>());
    }
  }
  rectangle.head<2>().array() -= kMarginPx / f_px;
  rectangle.tail<2>().array() += kMarginPx / f_px;

  program_.Set("u_clip_of_C", clip_of_C);
  program_.Set("u_B_of_C", X_BC.matrix());
  program_.Set("u_f_px", f_px);
  program_.Set("u_depth", WindowDepth(clip_of_C));
  program_.Set("u_rectangle", rectangle);
  program_.Set("u_colour", colour);
  program_.Set("u_normal_C", normal);
  program_.Set("u_centre_C", centre);
  program_.Set("u_radius", static_cast<float>(shape_.radius));
  const bool is_disc = shape_.kind == TargetShape::Kind::kDisc;
  program_.Set("u_num_edges", is_disc ? 0 : static_cast<int>(outline_.size()));
  if (!is_disc) {
    const std::vector<Vector3f> edges = EdgesOf(Project(outline_, X_CO));
    for (std::size_t i = 0; i < edges.size(); ++i) {
      program_.Set(Indexed("u_edges", i).c_str(), edges[i]);
    }
  }
  if (motion) {
    SetMotion(*motion);
  }
  glBindVertexArray(no_vertices_);
  glDrawArrays(GL_TRIANGLE_STRIP, 0, 4);
}

}  // namespace fovea::sim
