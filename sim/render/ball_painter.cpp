// SPDX-License-Identifier: Apache-2.0
#include "sim/render/ball_painter.hpp"

#include <algorithm>

#include "sim/render/projection.hpp"
#include "sim/render/shaders.hpp"

namespace fovea::sim {
namespace {

using Eigen::Vector3f;
using Eigen::Vector4f;

// Around the outlines of a ball at all of `centres`, two pixels wider.
Vector4f RectangleAround(std::initializer_list<Vector3f> centres, float radius, double f_px) {
  Vector4f all(1e9F, 1e9F, -1e9F, -1e9F);
  for (const Vector3f& centre : centres) {
    const Vector4f one = OutlineRectangle(centre, radius, static_cast<float>(2.0 / f_px));
    all.head<2>() = all.head<2>().cwiseMin(one.head<2>());
    all.tail<2>() = all.tail<2>().cwiseMax(one.tail<2>());
  }
  return all;
}

}  // namespace

BallPainter::BallPainter(const std::string& head)
    : program_(head + shaders::kBallVertex,
               head + shaders::kLight + shaders::kShadow + shaders::kRows + shaders::kBallFragment) {
  glGenVertexArrays(1, &no_vertices_);
}

BallPainter::~BallPainter() { glDeleteVertexArrays(1, &no_vertices_); }

void BallPainter::Draw(std::vector<SeenBall> balls, const Eigen::Isometry3f& X_BC, const Pinhole& pinhole,
                       const Eigen::Matrix4f& clip_of_C, const std::optional<float>& rows) const {
  std::sort(balls.begin(), balls.end(), [](const SeenBall& a, const SeenBall& b) {
    return a.centre.squaredNorm() > b.centre.squaredNorm();
  });
  program_.Set("u_clip_of_C", clip_of_C);
  program_.Set("u_B_of_C", X_BC.matrix());
  program_.Set("u_f_px", static_cast<float>(pinhole.f_px));
  program_.Set("u_depth", WindowDepth(clip_of_C));
  glBindVertexArray(no_vertices_);
  for (const SeenBall& ball : balls) {
    const Vector3f& c = ball.centre;
    if (c.z() < 1.5F * ball.radius + kNear || !InView(pinhole, c, ball.radius)) {
      continue;
    }
    program_.Set("u_rectangle", RectangleAround({c, ball.first, ball.last}, ball.radius, pinhole.f_px));
    program_.Set("u_ball_C", Vector4f(c.x(), c.y(), c.z(), ball.radius));
    program_.Set("u_colour", ball.colour);
    if (rows) {
      program_.Set("u_centre_rate", Vector3f((ball.last - ball.first) / *rows));
    }
    glDrawArrays(GL_TRIANGLE_STRIP, 0, 4);
  }
}

}  // namespace fovea::sim
