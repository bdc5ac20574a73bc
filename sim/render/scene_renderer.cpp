// SPDX-License-Identifier: Apache-2.0
#include "sim/render/scene_renderer.hpp"

#include <epoxy/gl.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <stdexcept>
#include <utility>

#include "sim/render/ball_painter.hpp"
#include "sim/render/canvas.hpp"
#include "sim/render/cover.hpp"
#include "sim/render/egl_context.hpp"
#include "sim/render/gl_program.hpp"
#include "sim/render/gpu_mesh.hpp"
#include "sim/render/light.hpp"
#include "sim/render/outline_smoother.hpp"
#include "sim/render/plane_painter.hpp"
#include "sim/render/plate_painter.hpp"
#include "sim/render/projection.hpp"
#include "sim/render/scene_bodies.hpp"
#include "sim/render/shaders.hpp"
#include "sim/render/shadow_map.hpp"

namespace fovea::sim {
namespace {

using Eigen::Isometry3f;
using Eigen::Matrix4f;
using Eigen::Vector3f;
using Eigen::Vector4f;

}  // namespace

struct SceneRenderer::Impl {
  RenderScene scene;
  Pinhole pinhole;
  const RenderQuality quality;
  const int index;
  std::optional<SensorRows> sensor;
  EglContext egl;
  std::string head;  // of programs that use the moving shadow
  std::unique_ptr<GlProgram> mesh_program, hem_program;
  std::unique_ptr<Canvas> canvas;
  std::unique_ptr<OutlineSmoother> smoother;
  std::unique_ptr<ShadowMap> shadow;
  std::unique_ptr<PlanePainter> planes;
  std::unique_ptr<BallPainter> balls;
  std::unique_ptr<PlatePainter> plate;  // null if the target is a ball, or there is none
  std::vector<Thing> things;
  std::vector<Link> links;
  std::unique_ptr<GpuMesh> unit_ball;
  RenderWatch watch;

  Impl(const RenderScene& s, const Pinhole& p, const RenderQuality& q, int i,
       const std::optional<SensorRows>& r, std::span<const PaintedSurface> painted)
      : quality(q), index(i), egl(i) {
    egl.MakeCurrent();
    head = fmt::format("#version 330 core\n#define SHADOW_TAPS {}\n#define SHADOW_SPREAD {:.3f}\n{}",
                       quality.shadow_taps, quality.shadow_spread, r ? "#define ROLLING\n" : "");
    const std::string light = shaders::kLight;
    const std::string lit = shaders::kShadow;
    mesh_program =
        std::make_unique<GlProgram>(head + light + shaders::kMeshVertex, head + lit + shaders::kMeshFragment);
    hem_program =
        std::make_unique<GlProgram>(head + light + shaders::kHemVertex, head + lit + shaders::kHemFragment);
    smoother = std::make_unique<OutlineSmoother>();
    balls = std::make_unique<BallPainter>(head);
    shadow = std::make_unique<ShadowMap>(quality.shadow_map_px);
    unit_ball = std::make_unique<GpuMesh>(MakeSphere(1.0F, 24, Vector3f::Ones()));
    things = UploadThings(*s.bench);
    Show(s, p, r);
    const auto draw_static = [this](const ShadowMap::DrawAt& draw) { DrawStaticCasters(draw); };
    shadow->DrawStatic(draw_static);
    planes = std::make_unique<PlanePainter>(scene.bench->planes, head, draw_static, painted);
  }

  ~Impl() { egl.MakeCurrent(); }

  void Show(const RenderScene& s, const Pinhole& p, const std::optional<SensorRows>& rows) {
    egl.MakeCurrent();
    const bool same_size =
        canvas != nullptr && p.width_px == pinhole.width_px && p.height_px == pinhole.height_px;
    scene = s;
    pinhole = p;
    sensor = rows;
    watch = {};
    links = UploadLinks(scene.robot, scene.has_eye ? &scene.X_EC : nullptr);
    plate.reset();
    if (scene.has_eye && scene.target.kind != TargetShape::Kind::kBall) {
      plate = std::make_unique<PlatePainter>(scene.target, head);
    }
    if (!same_size) {
      canvas = std::make_unique<Canvas>(pinhole.width_px, pinhole.height_px, quality.samples);
    }
  }

  Ball Target(const Moment& moment) const {
    if (!HasBall()) {
      return {Vector3f(0.0F, 0.0F, -10.0F), 1e-3F, scene.target_colour};  // far under the table
    }
    return {moment.p_BO.cast<float>(), static_cast<float>(scene.target.radius), scene.target_colour};
  }
  bool HasBall() const { return scene.has_eye && scene.target.kind == TargetShape::Kind::kBall; }
  static Isometry3f PlatePose(const Moment& moment) {
    Eigen::Isometry3d X_BO = Eigen::Isometry3d::Identity();
    X_BO.linear() = moment.R_BO;
    X_BO.translation() = moment.p_BO;
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
    for (const Ball& ball : scene.bench->balls) {
      DrawBallCaster(ball, draw);
    }
  }

  void DrawMovingCasters(const Moment& moment, const ShadowMap::DrawAt& draw) const {
    for (std::size_t i = 0; i < links.size() && i < moment.X_BL.size(); ++i) {
      draw(*links[i].shadow, moment.X_BL[i].matrix().cast<float>());
    }
    DrawBallCaster(Target(moment), draw);
    if (plate) {
      draw(plate->caster(), PlatePose(moment).matrix());
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

  // The box that contains everything visible in the picture `shown`; none if there is no such box.
  std::optional<Box> Seen(const Isometry3f& X_BC, const Pinhole& shown) const {
    for (const TexturedPlane& plane : scene.bench->planes) {
      if (const std::optional<Box> seen = SeenOver(plane, shown, X_BC); seen && quality.skip_hidden) {
        return seen;
      }
    }
    return std::nullopt;
  }

  // The picture of some rows alone, and of some around them that hems reach from.
  [[nodiscard]] Pinhole PictureOf(int begin, int rows) const {
    constexpr int kAround = 4;
    Pinhole part = pinhole;
    const int first = std::max(begin - kAround, 0);
    part.height_px = std::min(begin + rows + kAround, pinhole.height_px) - first;
    part.c_v_px -= first;
    return part;
  }

  // Those that may be in the picture `shown`.
  void DrawMeshes(const Moment& moment, const Isometry3f& X_BC, const Matrix4f& clip_of_B,
                  const Pinhole& shown, const std::optional<Box>& seen) const {
    const Isometry3f X_CB = X_BC.inverse();
    SetLight(*mesh_program, X_BC);
    mesh_program->Set("u_clip_of_B", clip_of_B);
    for (std::size_t i = 0; i < links.size() && i < moment.X_BL.size(); ++i) {
      const Isometry3f X_BL = moment.X_BL[i].cast<float>();
      if (InView(shown, X_CB * (X_BL * links[i].bounds.centre), links[i].bounds.radius)) {
        mesh_program->Set("u_B_of_mesh", X_BL.matrix());
        links[i].mesh->Draw();
        smoother->Add(links[i].edges, X_BL, X_BC.translation());
      }
    }
    mesh_program->Set("u_B_of_mesh", Matrix4f(Matrix4f::Identity()));
    for (const Thing& thing : things) {
      const bool hidden = seen && !seen->intersects(thing.box);
      if (!hidden && InView(shown, X_CB * thing.bounds.centre, thing.bounds.radius)) {
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

  void DrawPlanes(const Moment& moment, const Matrix4f& clip_of_B, const std::optional<Box>& seen) const {
    const Ball target = Target(moment);
    std::vector<MovingBounds> moving{BoxAbout(target.p_B, target.radius)};
    if (plate) {
      moving.push_back(BoxAbout(moment.p_BO.cast<float>(), static_cast<float>(scene.target.Reach())));
    }
    for (std::size_t i = 0; i < links.size() && i < moment.X_BL.size(); ++i) {
      const Isometry3f X_BL = moment.X_BL[i].cast<float>();
      for (const Box& shape : links[i].shapes) {
        moving.push_back({X_BL, shape});
      }
    }
    const float bottom = seen ? seen->min().z() : -std::numeric_limits<float>::infinity();
    planes->Draw(clip_of_B, static_cast<float>(scene.light), *shadow, target, moving, bottom);
  }

  // The rows of a band, for a program that draws a target.
  void SetRows(const GlProgram& program, const RowBand& band) const {
    const std::array<double, 5>& k = sensor->lens;
    program.Set("u_rows",
                Vector3f(Eigen::Vector3d(sensor->f_v_px, sensor->c_v_px, band.middle_row).cast<float>()));
    program.Set("u_lens", Vector4f(Eigen::Vector4d(k[0], k[1], k[2], k[3]).cast<float>()));
    program.Set("u_k3", static_cast<float>(k[4]));
  }

  void DrawPlate(const Moment& moment, const Isometry3f& X_BC, const Matrix4f& clip_of_C,
                 const RowBand* band) const {
    if (!plate) {
      return;
    }
    SetLight(plate->program(), X_BC);
    std::optional<PlateMotion> motion;
    if (band != nullptr) {
      SetRows(plate->program(), *band);
      const auto X_CO = [](const Moment& m) { return m.X_BC.cast<float>().inverse() * PlatePose(m); };
      motion = {X_CO(band->first), X_CO(band->last), static_cast<float>(band->rows)};
    }
    plate->Draw(X_BC.inverse() * PlatePose(moment), X_BC, pinhole, clip_of_C, scene.target_colour, motion);
  }

  void DrawBalls(const Moment& moment, const Isometry3f& X_BC, const Matrix4f& clip_of_C,
                 const RowBand* band) const {
    const auto see = [](const Ball& ball, const Isometry3f& X_CB) {
      return SeenBall{X_CB * ball.p_B, ball.radius, ball.colour};
    };
    const auto add = [&](const auto& ball_at) {
      SeenBall ball = see(ball_at(moment), X_BC.inverse());
      if (band != nullptr) {
        ball.first = see(ball_at(band->first), band->first.X_BC.cast<float>().inverse()).centre;
        ball.last = see(ball_at(band->last), band->last.X_BC.cast<float>().inverse()).centre;
      }
      return ball;
    };
    std::vector<SeenBall> seen;
    for (const Ball& ball : scene.bench->balls) {
      seen.push_back(add([&ball](const Moment&) { return ball; }));
    }
    seen.push_back(add([this](const Moment& m) { return Target(m); }));
    SetLight(balls->program(), X_BC);
    std::optional<float> rows;
    if (band != nullptr) {
      SetRows(balls->program(), *band);
      rows = static_cast<float>(band->rows);
    }
    balls->Draw(std::move(seen), X_BC, pinhole, clip_of_C, rows);
  }

  // With `band`: only its rows.
  void Draw(const Moment& moment, const Eigen::Isometry3d& X_BC_exact, const RowBand* band,
            std::span<const PictureArea> areas, std::span<std::uint8_t> rgba) {
    egl.MakeCurrent();
    const int begin = band != nullptr ? band->begin_px : 0;
    const int rows = band != nullptr ? band->end_px - begin : pinhole.height_px;
    const Isometry3f X_BC = X_BC_exact.cast<float>();
    const Matrix4f clip_of_C = ClipOfC(pinhole);
    const Matrix4f clip_of_B = clip_of_C * X_BC.inverse().matrix();
    shadow->DrawMoving([&](const ShadowMap::DrawAt& draw) { DrawMovingCasters(moment, draw); });
    Tell("shadow");
    if (band != nullptr) {
      glEnable(GL_SCISSOR_TEST);
      glScissor(0, begin, pinhole.width_px, rows);
    }

    canvas->Bind();
    const auto gain = static_cast<float>(scene.light);
    glClearColor(0.45F * gain, 0.46F * gain, 0.47F * gain, 1.0F);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    glEnable(GL_DEPTH_TEST);
    if (!areas.empty()) {
      canvas->DrawOnly(areas);
    }
    glActiveTexture(GL_TEXTURE1);
    glBindTexture(GL_TEXTURE_2D, shadow->texture());
    glActiveTexture(GL_TEXTURE0);
    // The table first: it fills most of the camera's picture and hides everything below it.
    glDisable(GL_CULL_FACE);  // tiles and the balls' rectangles have no back side
    const Pinhole shown = PictureOf(begin, rows);
    const std::optional<Box> seen = Seen(X_BC, shown);
    DrawPlanes(moment, clip_of_B, seen);
    Tell("planes");
    glEnable(GL_CULL_FACE);
    glFrontFace(GL_CW);  // see ClipOfC
    DrawMeshes(moment, X_BC, clip_of_B, shown, seen);
    Tell("meshes");
    glDisable(GL_CULL_FACE);
    glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
    DrawHems(X_BC, clip_of_B);
    Tell("outlines");
    glEnable(GL_BLEND);
    DrawPlate(moment, X_BC, clip_of_C, band);
    DrawBalls(moment, X_BC, clip_of_C, band);
    glDisable(GL_BLEND);

    canvas->Resolve();
    Tell("target and balls");
    canvas->Read(begin, rows, rgba);
    Tell("read-back");
    glDisable(GL_SCISSOR_TEST);
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
                             int index, const std::optional<SensorRows>& rows, SceneRenderer* twin) {
  std::vector<PaintedSurface> painted;
  if (twin != nullptr) {
    twin->impl_->egl.MakeCurrent();
    painted = twin->impl_->planes->Painted();
    twin->Release();
  }
  impl_ = std::make_unique<Impl>(scene, pinhole, quality, index, rows, painted);
  driver_name_ = impl_->egl.RendererName();
  Release();
}
SceneRenderer::~SceneRenderer() = default;

bool SceneRenderer::Fits(const RenderScene& scene, const RenderQuality& quality, int index,
                         const std::optional<SensorRows>& rows) const {
  return scene.bench == impl_->scene.bench && quality == impl_->quality && index == impl_->index &&
         rows.has_value() == impl_->sensor.has_value();
}

void SceneRenderer::Show(const RenderScene& scene, const Pinhole& pinhole,
                         const std::optional<SensorRows>& rows) {
  impl_->Show(scene, pinhole, rows);
  Release();
}

void SceneRenderer::CheckSize(std::span<const std::uint8_t> rgba) const {
  const auto needed = static_cast<std::size_t>(impl_->pinhole.width_px) *
                      static_cast<std::size_t>(impl_->pinhole.height_px) * 4;
  if (rgba.size() != needed) {
    throw std::invalid_argument("SceneRenderer: the buffer does not have the picture's size");
  }
}

void SceneRenderer::Draw(const Moment& moment, const Eigen::Isometry3d& X_BC, std::span<std::uint8_t> rgba,
                         std::span<const PictureArea> areas) {
  CheckSize(rgba);
  impl_->Draw(moment, X_BC, nullptr, areas, rgba);
}

void SceneRenderer::DrawBand(const RowBand& band, std::span<std::uint8_t> rgba,
                             std::span<const PictureArea> areas) {
  CheckSize(rgba);
  impl_->Draw(band.middle, band.middle.X_BC, &band, areas, rgba);
}

void SceneRenderer::Watch(RenderWatch watch) { impl_->watch = std::move(watch); }
void SceneRenderer::Release() { impl_->egl.Release(); }
const Pinhole& SceneRenderer::pinhole() const { return impl_->pinhole; }
int SceneRenderer::index() const { return impl_->index; }

}  // namespace fovea::sim
