// SPDX-License-Identifier: Apache-2.0
// A log's scene: shapes, meshes and poses over time, thinned if there are too many.
#include "firmware/host/report/scene_reader.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "firmware/host/recording/log/topics.hpp"

namespace fovea::report {
namespace {

using testing::ElementsAre;

template <class Primitive>
void Place(Primitive* primitive, double x) {
  primitive->mutable_pose()->mutable_position()->set_x(x);
  primitive->mutable_pose()->mutable_orientation()->set_w(1.0);
  primitive->mutable_color()->set_g(0.5);
}

void AddTransform(foxglove::FrameTransforms& transforms, const char* frame, double x) {
  foxglove::FrameTransform* transform = transforms.add_transforms();
  transform->set_child_frame_id(frame);
  transform->mutable_translation()->set_x(x);
  transform->mutable_rotation()->set_w(1.0);
}

TEST(SceneReaderTest, EveryShapeIsRead) {
  foxglove::SceneUpdate scene;
  scene.add_entities()->set_frame_id(log::kTargetFrame);  // the page draws the target itself
  foxglove::SceneEntity* entity = scene.add_entities();
  entity->set_frame_id("link");
  foxglove::CubePrimitive* cube = entity->add_cubes();
  Place(cube, 0.1);
  cube->mutable_size()->set_x(1.0);
  cube->mutable_size()->set_y(2.0);
  cube->mutable_size()->set_z(3.0);
  foxglove::CylinderPrimitive* cylinder = entity->add_cylinders();
  Place(cylinder, 0.2);
  cylinder->mutable_size()->set_x(0.4);
  cylinder->mutable_size()->set_z(0.7);
  foxglove::SpherePrimitive* sphere = entity->add_spheres();
  Place(sphere, 0.3);
  sphere->mutable_size()->set_x(0.5);
  for (const bool with_indices : {false, true}) {
    foxglove::TriangleListPrimitive* mesh = entity->add_triangles();
    Place(mesh, 0.4);
    for (int i = 0; i < 3; ++i) {
      mesh->add_points()->set_y(i);
    }
    for (const std::uint32_t index : {2U, 1U, 0U, 3U, 4'000'000'000U}) {  // the last two are out of range
      if (with_indices) {
        mesh->add_indices(index);
      }
    }
  }
  RunData run;
  SceneReader reader(run);
  reader.AddScene(scene);
  ASSERT_EQ(run.links.size(), 1U);
  const std::vector<SceneShape>& shapes = run.links[0].shapes;
  ASSERT_EQ(shapes.size(), 5U);
  EXPECT_THAT(shapes[0].size, ElementsAre(1.0, 2.0, 3.0));
  EXPECT_THAT(shapes[1].size, ElementsAre(0.2, 0.7)) << "radius, length";
  EXPECT_THAT(shapes[2].size, ElementsAre(0.25)) << "radius";
  EXPECT_EQ(shapes[2].position[0], 0.3);
  EXPECT_EQ(shapes[2].colour[1], 0.5);
  EXPECT_THAT(shapes[3].vertices, ElementsAre(0, 0, 0, 0, 1, 0, 0, 2, 0));
  EXPECT_THAT(shapes[4].vertices, ElementsAre(0, 2, 0, 0, 1, 0, 0, 0, 0));
}

// The page stays bounded for a run of any length, and the kept samples are evenly spaced.
TEST(SceneReaderTest, LongRunIsThinnedEvenly) {
  RunData run;
  SceneReader reader(run);
  foxglove::SceneUpdate scene;
  scene.add_entities()->set_frame_id("link");
  reader.AddScene(scene);
  constexpr int kFrames = 50'000;
  for (int i = 0; i < kFrames; ++i) {
    foxglove::FrameTransforms transforms;
    AddTransform(transforms, "link", i);
    AddTransform(transforms, log::kCameraFrame, 2.0 * i);
    AddTransform(transforms, log::kTargetFrame, 3.0 * i);
    reader.AddTransforms(transforms, i);
  }
  reader.AddScene(scene);  // too late: the poses have no slot for it
  reader.Finish();
  EXPECT_EQ(run.links.size(), 1U);
  const SceneMotion& motion = run.motion;
  const std::size_t frames = motion.t_s.size();
  ASSERT_GT(frames, 400U);
  ASSERT_LE(frames, 800U);
  ASSERT_EQ(motion.poses.size(), frames * 7);
  ASSERT_EQ(motion.camera_path.size(), frames * 3);
  ASSERT_EQ(motion.target_turn.size(), frames * 4);
  const float apart = motion.t_s[1] - motion.t_s[0];
  for (std::size_t i = 0; i < frames; ++i) {
    ASSERT_EQ(motion.t_s[i], apart * static_cast<float>(i));
    ASSERT_EQ(motion.poses[7 * i], motion.t_s[i]);
    ASSERT_EQ(motion.camera_path[3 * i], 2.0F * motion.t_s[i]);
    ASSERT_EQ(motion.target_path[3 * i], 3.0F * motion.t_s[i]);
  }
  EXPECT_GT(motion.t_s.back(), kFrames - 2.0F * apart);
}

TEST(SceneReaderTest, IncompleteTruthIsIgnored) {
  RunData run;
  SceneReader reader(run);
  foxglove::FrameTransforms transforms;
  AddTransform(transforms, log::kTargetFrame, 9.0);
  reader.AddTransforms(transforms, 0.5);
  log::Truth truth;
  truth.add_p_bo(1.0);
  reader.AddTruth(truth, 0.0);  // one number is not a position
  reader.Finish();
  EXPECT_EQ(run.motion.target_path[0], 9.0F) << "the servo's estimate is used";
  truth.add_p_bo(2.0);
  truth.add_p_bo(3.0);
  reader.AddTruth(truth, 0.0);
  reader.Finish();
  EXPECT_THAT(run.motion.target_path, ElementsAre(1.0F, 2.0F, 3.0F));
  EXPECT_THAT(run.motion.target_turn, ElementsAre(1.0F, 0.0F, 0.0F, 0.0F))
      << "identity, because the truth has no orientation";
}

}  // namespace
}  // namespace fovea::report
