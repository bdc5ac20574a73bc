// SPDX-License-Identifier: Apache-2.0
#include "sim/operator/served_page.hpp"

#include <exception>
#include <optional>
#include <utility>
#include <variant>

#include "firmware/core/model/types.hpp"
#include "firmware/host/recording/log/picture_messages.hpp"
#include "firmware/host/recording/log/run_messages.hpp"
#include "firmware/host/recording/log/topics.hpp"
#include "firmware/host/recording/log/transform_message.hpp"
#include "fovea/linux_rt/realtime.hpp"
#include "fovea/run.pb.h"
#include "foxglove/image.pb.h"
#include "foxglove/scene.pb.h"
#include "sim/run/truth_log.hpp"

namespace fovea::sim {
namespace {

constexpr std::chrono::milliseconds kLookPeriod{16};
constexpr std::int64_t kBenchPeriodNs = 16'000'000;          // of the world's time: a screen shows 60 Hz
constexpr std::chrono::milliseconds kServedStatePeriod{60};  // also for the target's handles on the page
constexpr std::chrono::milliseconds kSpeedPeriod{500};       // over which the speed is measured
// Longer than a slow computer's step. The robot may also hang, or wait for its client.
constexpr std::chrono::milliseconds kStepPatience{300};
constexpr const char* kStandstill = "the robot does not step: it hangs, or it waits for its client";

run::RunFacts FactsOfServed(const RunDescription& about) {
  run::RunFacts facts = FactsOf(about);
  facts.duration_s = 0.0;  // until somebody ends it
  return facts;
}

}  // namespace

ServedPage::ServedPage(live::ServerConfig config, const RunDescription& about, World& world,
                       ServedDesk::CameraFaults camera_faults)
    : about_(about),
      facts_(FactsOfServed(about)),
      world_(world),
      desk_(about, world, std::move(camera_faults)) {
  live::Catalogue catalogue = ServedDesk::Offer(about);
  catalogue.channels =
      live::LogChannels({.servo = false, .camera = about.scene.has_eye, .truth = about.scene.has_eye});
  server_ = std::make_unique<live::Server>(std::move(config), catalogue);
  feed_ = std::make_unique<live::LiveFeed>(*server_, catalogue.channels);
  ShowOnce();
  look_ = desk_.Look();
  state_ = desk_.State(look_);
  server_->SetState(state_);
  thread_ = std::thread([this] { Run(); });
}

ServedPage::~ServedPage() {
  closed_ = true;
  thread_.join();
  state_.ends = true;
  state_.notice = "";
  server_->SetState(state_);
}

void ServedPage::Show(const char* topic, std::int64_t stamp_ns, const google::protobuf::Message& message) {
  feed_->Take(topic, *message.GetDescriptor(), stamp_ns, message.SerializeAsString());
}

// What a new viewer gets first.
void ServedPage::ShowOnce() {
  const std::int64_t start_ns = world_.now_ns();
  Show(log::kSetupTopic, start_ns, log::SetupMessage(run::SetupOf(facts_, start_ns)));
  if (facts_.has_camera) {
    Show(log::kCalibrationTopic, start_ns, log::CalibrationMessage(start_ns, facts_.intrinsics));
  }
  Show(log::kSceneTopic, start_ns, facts_.scene);
}

void ServedPage::AfterStep() {
  LetGo();
  between_.Pass();
  desk_.Act();
}

void ServedPage::AddPicture(const hal::Frame& frame) {
  if (!feed_->Wants(log::kImageTopic)) {
    return;
  }
  const std::lock_guard lock(picture_mutex_);
  log::PictureOf(frame).copyTo(picture_);
  picture_ns_ = frame.stamp_ns;
}

void ServedPage::Run() {
  linux_rt::MakeThreadYielding("fovea-live");
  while (!closed_) {
    static_cast<void>(server_->WaitForCalls(kLookPeriod));
    if (server_->TakeCalls([this](const live::Call& call) { return Do(call); }) > 0) {
      state_due_ = true;
    }
    if (server_->viewers() > 0) {
      Look();
      ShowPicture();
    }
  }
}

live::Answer ServedPage::Do(const live::Call& call) {
  if (std::holds_alternative<live::End>(call.request)) {
    ended_ = true;
    return {};
  }
  if (AsksToLetGo(call.request)) {
    return {};
  }
  live::Answer answer;
  const auto act = [&] {
    LetGo();  // what was asked for before
    answer = desk_.Do(call);
  };
  if (!between_.Do(act, kStepPatience)) {
    return {"the robot's time stands still, because it hangs or waits for its client; try again", "{}"};
  }
  return answer;
}

// A request to let go is neither refused nor lost, even if the world does not step just now: otherwise the
// spring would pull for ever.
bool ServedPage::AsksToLetGo(const live::Request& request) {
  const bool of_both = std::holds_alternative<live::ControlEnded>(request);
  const bool of_target = of_both || std::holds_alternative<live::ReleaseTarget>(request);
  const bool of_arm = of_both || std::holds_alternative<live::Release>(request);
  if (of_target) {
    let_target_go_.store(true, std::memory_order_release);
  }
  if (of_arm) {
    let_arm_go_.store(true, std::memory_order_release);
  }
  return of_target || of_arm;
}

// From the world's thread.
void ServedPage::LetGo() {
  const auto take = [](std::atomic<bool>& asked) {
    return asked.load(std::memory_order_relaxed) && asked.exchange(false, std::memory_order_acquire);
  };
  if (take(let_target_go_)) {
    desk_.LetTargetGo();
  }
  if (take(let_arm_go_)) {
    desk_.LetArmGo();
  }
}

void ServedPage::Look() {
  const auto visit = [this] {
    LetGo();
    look_ = desk_.Look();
  };
  if (!between_.Do(visit, kStepPatience)) {
    ShowStandstill();
    return;
  }
  server_->SetTime(look_.stamp_ns);
  if (look_.stamp_ns >= next_bench_ns_) {
    next_bench_ns_ = look_.stamp_ns + kBenchPeriodNs;
    ShowBench();
  }
  if (state_due_ || Clock::now() >= next_state_) {
    state_due_ = false;
    next_state_ = Clock::now() + kServedStatePeriod;
    ShowState();
  }
}

void ServedPage::ShowBench() {
  const bool has_target = about_.scene.has_eye;
  const model::Pose X_BO{look_.hands.X_BO.linear(), look_.hands.X_BO.translation()};
  if (has_target && feed_->Wants(log::kTruthTopic)) {
    Truth truth;
    truth.stamp_ns = look_.stamp_ns;
    truth.X_BC = look_.X_BC;
    truth.p_BO = X_BO.p;
    truth.R_BO = X_BO.R;
    Show(log::kTruthTopic, look_.stamp_ns, log::TruthMessage(TruthSampleOf(about_, truth)));
  }
  const model::VecN q = model::ToVector(look_.q, look_.num_joints);
  if (feed_->Wants(log::kTransformTopic) && q.allFinite()) {
    log::SetTransforms(look_.stamp_ns, facts_.servo.arm, facts_.frames, q,
                       has_target ? std::optional(X_BO) : std::nullopt, transforms_);
    Show(log::kTransformTopic, look_.stamp_ns, transforms_);
  }
}

// The last state, with the reason why there is no newer one.
void ServedPage::ShowStandstill() {
  const Clock::time_point now = Clock::now();
  speed_ = 0.0;
  speed_from_ = now;
  speed_from_s_ = static_cast<double>(look_.stamp_ns) * 1e-9;
  state_.real_time_factor = 0.0;
  state_.wall_s = std::chrono::duration<double>(now - begin_).count();
  state_.notice = kStandstill;
  server_->SetState(state_);
}

void ServedPage::ShowState() {
  live::State state = desk_.State(look_);
  const Clock::time_point now = Clock::now();
  if (now - speed_from_ >= kSpeedPeriod) {
    speed_ = (state.stamp_s - speed_from_s_) / std::chrono::duration<double>(now - speed_from_).count();
    speed_from_ = now;
    speed_from_s_ = state.stamp_s;
  }
  state.real_time_factor = speed_;
  state.wall_s = std::chrono::duration<double>(now - begin_).count();
  state_ = std::move(state);
  server_->SetState(state_);
}

void ServedPage::ShowPicture() {
  cv::Mat picture;
  std::int64_t stamp_ns = 0;
  {
    const std::lock_guard lock(picture_mutex_);
    std::swap(picture, picture_);
    stamp_ns = picture_ns_;
  }
  if (picture.empty()) {
    return;
  }
  try {
    Show(log::kImageTopic, stamp_ns, log::ImageMessage(picture, stamp_ns, log::kJpegQuality));
  } catch (const std::exception&) {
    // A viewer misses this picture.
  }
}

}  // namespace fovea::sim
