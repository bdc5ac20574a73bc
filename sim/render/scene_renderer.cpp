// SPDX-License-Identifier: Apache-2.0
#include "sim/render/scene_renderer.hpp"

#include <epoxy/gl.h>
#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <optional>
#include <stdexcept>
#include <utility>

#include "sim/render/cover.hpp"
#include "sim/render/egl_context.hpp"
#include "sim/render/gl_program.hpp"
#include "sim/render/gpu_mesh.hpp"
#include "sim/render/light.hpp"
#include "sim/render/link_parts.hpp"
#include "sim/render/outline_smoother.hpp"
#include "sim/render/plane_painter.hpp"
#include "sim/render/plate_painter.hpp"
#include "sim/render/projection.hpp"
#include "sim/render/shaders.hpp"
#include "sim/render/shadow_map.hpp"

namespace fovea::sim {
namespace {

using Eigen::Isometry3f;
using Eigen::Matrix4f;
using Eigen::Vector3f;
using Eigen::Vector4f;

// A static thing, with its bounds to skip it when it is out of view.
struct Thing {
  std::unique_ptr<GpuMesh> mesh;
  std::vector<MeshEdge> edges;
  Bounds bounds;
  Box box;
};

// A link's meshes for the picture and for its shadow.
struct Link {
  std::unique_ptr<GpuMesh> mesh;
  std::unique_ptr<GpuMesh> shadow;
  std::vector<MeshEdge> edges;
  Bounds bounds;
  std::vector<Box> shapes;  // tighter bounds: one box per solid
};

}  // namespace

struct SceneRenderer::Impl {
  RenderScene scene;
  Pinhole pinhole;
  RenderQuality quality;
  EglContext egl;
  std::unique_ptr<GlProgram> mesh_program, hem_program, ball_program;
  std::unique_ptr<OutlineSmoother> smoother;
  std::unique_ptr<ShadowMap> shadow;
  std::unique_ptr<PlanePainter> planes;
  std::unique_ptr<PlatePainter> plate;  // null if the target is a ball, or there is none
  std::vector<Thing> things;
  std::vector<Link> links;
  std::unique_ptr<GpuMesh> unit_ball;
  GLuint no_vertices = 0;    // for balls, which are drawn from uniforms only
  GLuint frame[2] = {0, 0};  // drawn into (may be multisampled), resolved
  GLuint buffers[3] = {0, 0, 0};
  RenderWatch watch;

  Impl(const RenderScene& s, const Pinhole& p, const RenderQuality& q, int index)
      : scene(s), pinhole(p), quality(q), egl(index) {
    egl.MakeCurrent();
    const std::string head =
        fmt::format("#version 330 core\n#define SHADOW_TAPS {}\n#define SHADOW_SPREAD {:.3f}\n",
                    quality.shadow_taps, quality.shadow_spread);
    const std::string light = shaders::kLight;
    const std::string lit = shaders::kShadow;
    mesh_program =
        std::make_unique<GlProgram>(head + light + shaders::kMeshVertex, head + lit + shaders::kMeshFragment);
    hem_program =
        std::make_unique<GlProgram>(head + light + shaders::kHemVertex, head + lit + shaders::kHemFragment);
    smoother = std::make_unique<OutlineSmoother>();
    ball_program =
        std::make_unique<GlProgram>(head + shaders::kBallVertex, head + light + lit + shaders::kBallFragment);
    if (scene.has_eye && scene.target.kind != TargetShape::Kind::kBall) {
      plate = std::make_unique<PlatePainter>(scene.target, head);
    }
    shadow = std::make_unique<ShadowMap>(quality.shadow_map_px);
    Upload();
    MakeFrames();
    const auto draw_static = [this](const ShadowMap::DrawAt& draw) { DrawStaticCasters(draw); };
    shadow->DrawStatic(draw_static);
    planes = std::make_unique<PlanePainter>(scene.bench.planes, head, draw_static);
  }

  ~Impl() {
    egl.MakeCurrent();
    glDeleteVertexArrays(1, &no_vertices);
    glDeleteFramebuffers(2, frame);
    glDeleteRenderbuffers(3, buffers);
  }

  void Upload() {
    for (const Mesh& mesh : scene.bench.things) {
      things.push_back({std::make_unique<GpuMesh>(mesh), FindEdges(mesh), FindBounds(mesh), FindBox(mesh)});
    }
    for (std::size_t i = 0; i < scene.robot.links.size(); ++i) {
      const SimLink& link = scene.robot.links[i];
      const Isometry3f X_EC = scene.X_EC.cast<float>();
      const Isometry3f* camera = scene.has_eye && static_cast<int>(i) == scene.robot.tip ? &X_EC : nullptr;
      const std::vector<Mesh> seen = MakeParts(link, camera, Detail::kPicture);
      const std::vector<Mesh> casters = MakeParts(link, camera, Detail::kShadow);
      std::vector<Box> shapes;
      for (std::size_t k = 0; k < link.visuals.size(); ++k) {
        shapes.push_back(FindBox(casters[k]));
      }
      const Mesh mesh = Join(seen);
      links.push_back({std::make_unique<GpuMesh>(mesh), std::make_unique<GpuMesh>(Join(casters)),
                       FindAllEdges(seen), FindBounds(mesh), std::move(shapes)});
    }
    unit_ball = std::make_unique<GpuMesh>(MakeSphere(1.0F, 24, Vector3f::Ones()));
    glGenVertexArrays(1, &no_vertices);
  }

  void MakeFrames() {
    const int samples = quality.samples > 1 ? quality.samples : 0;
    glGenFramebuffers(2, frame);
    glGenRenderbuffers(3, buffers);
    const auto attach = [&](GLuint buffer, GLenum format, GLenum point, int count) {
      glBindRenderbuffer(GL_RENDERBUFFER, buffer);
      glRenderbufferStorageMultisample(GL_RENDERBUFFER, count, format, pinhole.width_px, pinhole.height_px);
      glFramebufferRenderbuffer(GL_FRAMEBUFFER, point, GL_RENDERBUFFER, buffer);
    };
    glBindFramebuffer(GL_FRAMEBUFFER, frame[0]);
    attach(buffers[0], GL_RGBA8, GL_COLOR_ATTACHMENT0, samples);
    attach(buffers[1], GL_DEPTH_COMPONENT24, GL_DEPTH_ATTACHMENT, samples);
    CheckFramebuffer("picture");
    glBindFramebuffer(GL_FRAMEBUFFER, frame[1]);
    attach(buffers[2], GL_RGBA8, GL_COLOR_ATTACHMENT0, 0);
    CheckFramebuffer("resolved picture");
  }

  Ball Target(const Exposure& exposure) const {
    if (!HasBall()) {
      return {Vector3f(0.0F, 0.0F, -10.0F), 1e-3F, scene.target_colour};  // far under the table
    }
    return {exposure.p_BO.cast<float>(), static_cast<float>(scene.target.radius), scene.target_colour};
  }
  bool HasBall() const { return scene.has_eye && scene.target.kind == TargetShape::Kind::kBall; }
  static Isometry3f PlatePose(const Exposure& exposure) {
    Eigen::Isometry3d X_BO = Eigen::Isometry3d::Identity();
    X_BO.linear() = exposure.R_BO;
    X_BO.translation() = exposure.p_BO;
    return X_BO.cast<float>();
  }

  void DrawBallCaster(const Ball& ball, const ShadowMap::DrawAt& draw) const {
    Matrix4f m = Matrix4f::Identity() * ball.radius;
    m.block<3, 1>(0, 3) = ball.p_B;
    m(3, 3) = 1.0F;
    draw(*unit_ball, m);
  }

  void DrawStaticCasters(const ShadowMap::DrawAt& draw) const {
    for (const Thing& thing : things) {
      draw(*thing.mesh, Matrix4f::Identity());
    }
    for (const Ball& ball : scene.bench.balls) {
      DrawBallCaster(ball, draw);
    }
  }

  void DrawMovingCasters(const Exposure& exposure, const ShadowMap::DrawAt& draw) const {
    for (std::size_t i = 0; i < links.size() && i < exposure.X_BL.size(); ++i) {
      draw(*links[i].shadow, exposure.X_BL[i].matrix().cast<float>());
    }
    DrawBallCaster(Target(exposure), draw);
    if (plate) {
      draw(plate->caster(), PlatePose(exposure).matrix());
    }
  }

  void SetLight(const GlProgram& program, const Isometry3f& X_BC) const {
    program.Use();
    program.Set("u_sun_B", kSun_B);
    program.Set("u_sun_light", kSunLight);
    program.Set("u_sky_from_above", kSkyFromAbove);
    program.Set("u_sky_from_below", kSkyFromBelow);
    program.Set("u_eye_B", Vector3f(X_BC.translation()));
    program.Set("u_gain", static_cast<float>(scene.light));
    program.Set("u_shadow_of_B", shadow->map_of_B());
    program.Set("u_shadow_lift", 1.5F * shadow->texel_m());
    program.Set("u_shadow_texel", 1.0F / static_cast<float>(quality.shadow_map_px));
    program.Set("u_shadow", 1);
  }

  // The box that contains everything visible; none if there is no such box.
  std::optional<Box> Seen(const Isometry3f& X_BC) const {
    for (const TexturedPlane& plane : scene.bench.planes) {
      if (const std::optional<Box> seen = SeenOver(plane, pinhole, X_BC); seen && quality.skip_hidden) {
        return seen;
      }
    }
    return std::nullopt;
  }

  void DrawMeshes(const Exposure& exposure, const Isometry3f& X_BC, const Matrix4f& clip_of_B,
                  const std::optional<Box>& seen) const {
    const Isometry3f X_CB = X_BC.inverse();
    SetLight(*mesh_program, X_BC);
    mesh_program->Set("u_clip_of_B", clip_of_B);
    for (std::size_t i = 0; i < links.size() && i < exposure.X_BL.size(); ++i) {
      const Isometry3f X_BL = exposure.X_BL[i].cast<float>();
      if (InView(pinhole, X_CB * (X_BL * links[i].bounds.centre), links[i].bounds.radius)) {
        mesh_program->Set("u_B_of_mesh", X_BL.matrix());
        links[i].mesh->Draw();
        smoother->Add(links[i].edges, X_BL, X_BC.translation());
      }
    }
    mesh_program->Set("u_B_of_mesh", Matrix4f(Matrix4f::Identity()));
    for (const Thing& thing : things) {
      const bool hidden = seen && !seen->intersects(thing.box);
      if (!hidden && InView(pinhole, X_CB * thing.bounds.centre, thing.bounds.radius)) {
        thing.mesh->Draw();
        smoother->Add(thing.edges, Isometry3f::Identity(), X_BC.translation());
      }
    }
  }

  void DrawHems(const Isometry3f& X_BC, const Matrix4f& clip_of_B) const {
    SetLight(*hem_program, X_BC);
    hem_program->Set("u_clip_of_B", clip_of_B);
    hem_program->Set("u_half_size_px", Eigen::Vector2f(0.5F * static_cast<float>(pinhole.width_px),
                                                       0.5F * static_cast<float>(pinhole.height_px)));
    glEnable(GL_BLEND);
    glDepthMask(GL_FALSE);
    smoother->Draw();
    glDepthMask(GL_TRUE);
    glDisable(GL_BLEND);
  }

  static MovingBounds BoxAbout(const Vector3f& p_B, float reach) {
    const Vector3f half = Vector3f::Constant(reach);
    return {Isometry3f::Identity(), {p_B - half, p_B + half}};
  }

  void DrawPlanes(const Exposure& exposure, const Matrix4f& clip_of_B, const std::optional<Box>& seen) const {
    const Ball target = Target(exposure);
    std::vector<MovingBounds> moving{BoxAbout(target.p_B, target.radius)};
    if (plate) {
      moving.push_back(BoxAbout(exposure.p_BO.cast<float>(), static_cast<float>(scene.target.Reach())));
    }
    for (std::size_t i = 0; i < links.size() && i < exposure.X_BL.size(); ++i) {
      const Isometry3f X_BL = exposure.X_BL[i].cast<float>();
      for (const Box& shape : links[i].shapes) {
        moving.push_back({X_BL, shape});
      }
    }
    const float bottom = seen ? seen->min().z() : -std::numeric_limits<float>::infinity();
    planes->Draw(clip_of_B, static_cast<float>(scene.light), *shadow, target, moving, bottom);
  }

  void DrawPlate(const Exposure& exposure, const Isometry3f& X_BC, const Matrix4f& clip_of_C) const {
    if (!plate) {
      return;
    }
    glEnable(GL_BLEND);
    SetLight(plate->program(), X_BC);
    plate->Draw(X_BC.inverse() * PlatePose(exposure), X_BC, pinhole, clip_of_C, scene.target_colour);
    glDisable(GL_BLEND);
  }

  // Drawn last, over their background, by the covered share of each pixel; far balls first.
  void DrawBalls(const Exposure& exposure, const Isometry3f& X_BC, const Matrix4f& clip_of_C) const {
    const Isometry3f X_CB = X_BC.inverse();
    std::vector<Ball> balls = scene.bench.balls;
    balls.push_back(Target(exposure));
    std::sort(balls.begin(), balls.end(), [&](const Ball& a, const Ball& b) {
      return (X_CB * a.p_B).squaredNorm() > (X_CB * b.p_B).squaredNorm();
    });
    glEnable(GL_BLEND);
    SetLight(*ball_program, X_BC);
    ball_program->Set("u_clip_of_C", clip_of_C);
    ball_program->Set("u_B_of_C", X_BC.matrix());
    ball_program->Set("u_f_px", static_cast<float>(pinhole.f_px));
    ball_program->Set("u_depth", WindowDepth(clip_of_C));
    glBindVertexArray(no_vertices);
    for (const Ball& ball : balls) {
      const Vector3f c = X_CB * ball.p_B;
      if (c.z() < 1.5F * ball.radius + kNear || !InView(pinhole, c, ball.radius)) {
        continue;
      }
      ball_program->Set("u_rectangle",
                        OutlineRectangle(c, ball.radius, static_cast<float>(2.0 / pinhole.f_px)));
      ball_program->Set("u_ball_C", Vector4f(c.x(), c.y(), c.z(), ball.radius));
      ball_program->Set("u_colour", ball.colour);
      glDrawArrays(GL_TRIANGLE_STRIP, 0, 4);
    }
    glDisable(GL_BLEND);
  }

  void Draw(const Exposure& exposure, const Eigen::Isometry3d& X_BC_exact, std::span<std::uint8_t> rgba) {
    egl.MakeCurrent();
    const Isometry3f X_BC = X_BC_exact.cast<float>();
    const Matrix4f clip_of_C = ClipOfC(pinhole);
    const Matrix4f clip_of_B = clip_of_C * X_BC.inverse().matrix();
    shadow->DrawMoving([&](const ShadowMap::DrawAt& draw) { DrawMovingCasters(exposure, draw); });
    Tell("shadow");

    glBindFramebuffer(GL_FRAMEBUFFER, frame[0]);
    glViewport(0, 0, pinhole.width_px, pinhole.height_px);
    const auto gain = static_cast<float>(scene.light);
    glClearColor(0.45F * gain, 0.46F * gain, 0.47F * gain, 1.0F);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    glEnable(GL_DEPTH_TEST);
    glActiveTexture(GL_TEXTURE1);
    glBindTexture(GL_TEXTURE_2D, shadow->texture());
    glActiveTexture(GL_TEXTURE0);
    // The table first: it fills most of the camera's picture and hides everything below it.
    glDisable(GL_CULL_FACE);  // tiles and the balls' rectangles have no back side
    const std::optional<Box> seen = Seen(X_BC);
    DrawPlanes(exposure, clip_of_B, seen);
    Tell("planes");
    glEnable(GL_CULL_FACE);
    glFrontFace(GL_CW);  // see ClipOfC
    DrawMeshes(exposure, X_BC, clip_of_B, seen);
    Tell("meshes");
    glDisable(GL_CULL_FACE);
    glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
    DrawHems(X_BC, clip_of_B);
    Tell("outlines");
    DrawPlate(exposure, X_BC, clip_of_C);
    DrawBalls(exposure, X_BC, clip_of_C);

    if (quality.samples > 1) {
      glBindFramebuffer(GL_READ_FRAMEBUFFER, frame[0]);
      glBindFramebuffer(GL_DRAW_FRAMEBUFFER, frame[1]);
      glBlitFramebuffer(0, 0, pinhole.width_px, pinhole.height_px, 0, 0, pinhole.width_px, pinhole.height_px,
                        GL_COLOR_BUFFER_BIT, GL_NEAREST);
      glBindFramebuffer(GL_FRAMEBUFFER, frame[1]);
    }
    Tell("target and balls");
    glReadPixels(0, 0, pinhole.width_px, pinhole.height_px, GL_RGBA, GL_UNSIGNED_BYTE, rgba.data());
    Tell("read-back");
  }

  // Waits until the driver has finished the part, so that a watcher can time it.
  void Tell(const char* part) const {
    if (watch) {
      glFinish();
      watch(part);
    }
  }
};

SceneRenderer::SceneRenderer(const RenderScene& scene, const Pinhole& pinhole, const RenderQuality& quality,
                             int index)
    : impl_(std::make_unique<Impl>(scene, pinhole, quality, index)) {
  driver_name_ = impl_->egl.RendererName();
  Release();
}
SceneRenderer::~SceneRenderer() = default;

void SceneRenderer::Draw(const Exposure& exposure, const Eigen::Isometry3d& X_BC,
                         std::span<std::uint8_t> rgba) {
  const auto needed = static_cast<std::size_t>(impl_->pinhole.width_px) *
                      static_cast<std::size_t>(impl_->pinhole.height_px) * 4;
  if (rgba.size() != needed) {
    throw std::invalid_argument("SceneRenderer::Draw: the buffer does not have the picture's size");
  }
  impl_->Draw(exposure, X_BC, rgba);
}

void SceneRenderer::Watch(RenderWatch watch) { impl_->watch = std::move(watch); }
void SceneRenderer::Release() { impl_->egl.Release(); }
const Pinhole& SceneRenderer::pinhole() const { return impl_->pinhole; }

}  // namespace fovea::sim
