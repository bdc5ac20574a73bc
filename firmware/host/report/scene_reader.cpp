// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/report/scene_reader.hpp"

#include <algorithm>

#include "firmware/host/recording/log/topics.hpp"
#include "firmware/host/report/envelope.hpp"

namespace fovea::report {
namespace {

constexpr std::size_t kMostFrames = 800;
constexpr std::size_t kPoseSize = 7;

// Keeps every second row of `row` values.
void Halve(std::vector<float>& values, std::size_t row) {
  if (row == 0) {
    return;
  }
  const std::size_t rows = values.size() / row;
  for (std::size_t i = 0; 2 * i < rows; ++i) {
    std::copy_n(values.begin() + static_cast<std::ptrdiff_t>(2 * i * row), row,
                values.begin() + static_cast<std::ptrdiff_t>(i * row));
  }
  values.resize((rows + 1) / 2 * row);
}

template <typename Primitive>
SceneShape MakeShape(const Primitive& primitive, const char* kind, std::vector<double> size) {
  SceneShape shape;
  shape.kind = kind;
  shape.size = std::move(size);
  const foxglove::Pose& pose = primitive.pose();
  shape.position = {pose.position().x(), pose.position().y(), pose.position().z()};
  shape.quaternion = {pose.orientation().w(), pose.orientation().x(), pose.orientation().y(),
                      pose.orientation().z()};
  shape.colour = {primitive.color().r(), primitive.color().g(), primitive.color().b()};
  return shape;
}

SceneShape MakeMesh(const foxglove::TriangleListPrimitive& triangles) {
  SceneShape shape = MakeShape(triangles, "mesh", {});
  const auto add = [&shape](const foxglove::Point3& point) {
    for (const double value : {point.x(), point.y(), point.z()}) {
      shape.vertices.push_back(static_cast<float>(value));
    }
  };
  if (triangles.indices_size() == 0) {
    std::for_each(triangles.points().begin(), triangles.points().end(), add);
  }
  for (const std::uint32_t index : triangles.indices()) {
    if (index < static_cast<std::uint32_t>(triangles.points_size())) {
      add(triangles.points(static_cast<int>(index)));
    }
  }
  return shape;
}

}  // namespace

void SceneReader::AddScene(const foxglove::SceneUpdate& scene) {
  if (!run_.motion.t_s.empty()) {
    return;  // later links have no column in the poses
  }
  for (const foxglove::SceneEntity& entity : scene.entities()) {
    // The page draws target and table itself.
    if (entity.frame_id() == log::kBaseFrame || entity.frame_id() == log::kTargetFrame) {
      continue;
    }
    SceneLink link;
    link.frame = entity.frame_id();
    for (const foxglove::CubePrimitive& cube : entity.cubes()) {
      link.shapes.push_back(MakeShape(cube, "box", {cube.size().x(), cube.size().y(), cube.size().z()}));
    }
    for (const foxglove::CylinderPrimitive& cylinder : entity.cylinders()) {
      link.shapes.push_back(
          MakeShape(cylinder, "cylinder", {0.5 * cylinder.size().x(), cylinder.size().z()}));
    }
    for (const foxglove::SpherePrimitive& sphere : entity.spheres()) {
      link.shapes.push_back(MakeShape(sphere, "sphere", {0.5 * sphere.size().x()}));
    }
    for (const foxglove::TriangleListPrimitive& triangles : entity.triangles()) {
      link.shapes.push_back(MakeMesh(triangles));
    }
    link_of_frame_[link.frame] = run_.links.size();
    run_.links.push_back(std::move(link));
  }
}

void SceneReader::AddTransforms(const foxglove::FrameTransforms& transforms, double t_s) {
  if (frames_seen_++ % stride_ != 0) {
    return;
  }
  SceneMotion& motion = run_.motion;
  const std::size_t begin = motion.poses.size();
  motion.t_s.push_back(static_cast<float>(t_s));
  motion.poses.resize(begin + run_.links.size() * kPoseSize, kGap);
  motion.camera_path.resize(motion.t_s.size() * 3, kGap);
  motion.target_path.resize(motion.t_s.size() * 3, kGap);
  motion.target_turn.resize(motion.t_s.size() * 4, kGap);
  for (const foxglove::FrameTransform& transform : transforms.transforms()) {
    const foxglove::Vector3& p = transform.translation();
    const foxglove::Quaternion& q = transform.rotation();
    const std::array<double, kPoseSize> pose{p.x(), p.y(), p.z(), q.w(), q.x(), q.y(), q.z()};
    const auto put = [&pose](std::vector<float>& to, std::size_t at, std::size_t count) {
      std::transform(pose.begin(), pose.begin() + static_cast<std::ptrdiff_t>(count),
                     to.begin() + static_cast<std::ptrdiff_t>(at),
                     [](double v) { return static_cast<float>(v); });
    };
    if (const auto link = link_of_frame_.find(transform.child_frame_id()); link != link_of_frame_.end()) {
      put(motion.poses, begin + link->second * kPoseSize, kPoseSize);
    }
    if (transform.child_frame_id() == log::kCameraFrame) {
      put(motion.camera_path, motion.camera_path.size() - 3, 3);
    } else if (transform.child_frame_id() == log::kTargetFrame) {
      put(motion.target_path, motion.target_path.size() - 3, 3);
      std::transform(pose.begin() + 3, pose.end(), motion.target_turn.end() - 4,
                     [](double v) { return static_cast<float>(v); });
    }
  }
  if (motion.t_s.size() > kMostFrames) {
    Thin();
  }
}

void SceneReader::Thin() {
  SceneMotion& motion = run_.motion;
  Halve(motion.t_s, 1);
  Halve(motion.poses, run_.links.size() * kPoseSize);
  Halve(motion.camera_path, 3);
  Halve(motion.target_path, 3);
  Halve(motion.target_turn, 4);
  stride_ *= 2;
}

void SceneReader::AddTruth(const log::Truth& truth, double t_s) {
  if (truth.p_bo_size() != 3 || truths_seen_++ % truth_stride_ != 0) {
    return;
  }
  truth_t_s_.push_back(static_cast<float>(t_s));
  for (const double value : truth.p_bo()) {
    truth_X_.push_back(static_cast<float>(value));
  }
  for (int i = 0; i < 4; ++i) {
    const double one = i == 0 ? 1.0 : 0.0;  // the identity
    truth_X_.push_back(static_cast<float>(truth.q_bo_size() == 4 ? truth.q_bo(i) : one));
  }
  if (truth_t_s_.size() > 16 * kMostFrames) {
    Halve(truth_t_s_, 1);
    Halve(truth_X_, kPoseSize);
    truth_stride_ *= 2;
  }
}

void SceneReader::Finish() {
  if (truth_t_s_.empty()) {
    return;
  }
  SceneMotion& motion = run_.motion;
  for (std::size_t i = 0; i < motion.t_s.size(); ++i) {
    const auto after = std::lower_bound(truth_t_s_.begin(), truth_t_s_.end(), motion.t_s[i]);
    const auto at = std::min<std::ptrdiff_t>(after - truth_t_s_.begin(),
                                             static_cast<std::ptrdiff_t>(truth_t_s_.size()) - 1);
    const auto X_BO = truth_X_.begin() + static_cast<std::ptrdiff_t>(kPoseSize) * at;
    std::copy_n(X_BO, 3, motion.target_path.begin() + static_cast<std::ptrdiff_t>(3 * i));
    std::copy_n(X_BO + 3, 4, motion.target_turn.begin() + static_cast<std::ptrdiff_t>(4 * i));
  }
}

}  // namespace fovea::report
