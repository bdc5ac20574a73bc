// SPDX-License-Identifier: Apache-2.0
#include "sim/operator/served_page.hpp"

#include <exception>
#include <utility>
#include <variant>

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

run::RunFacts FactsOfServed(const RunDescription& about) {
  run::RunFacts facts = FactsOf(about);
  facts.duration_s = 0.0;  // until somebody ends it
  return facts;
}

model::Pose TargetOf(const Truth& truth) { return {truth.R_BO, truth.p_BO}; }

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
  state_ = desk_.State();
  server_->SetState(state_);
  thread_ = std::thread([this] { Run(); });
}

ServedPage::~ServedPage() {
  closed_ = true;
  thread_.join();
  state_.ends = true;
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
  live::Answer answer;
  if (!between_.Do([&] { answer = desk_.Do(call); }, kStepPatience)) {
    return {"the robot's time stands still, because it hangs or waits for its client; try again", "{}"};
  }
  return answer;
}

void ServedPage::Look() {
  const bool state_due = state_due_ || Clock::now() >= next_state_;
  Truth truth;
  live::State state;
  const auto visit = [&] {
    truth = world_.truth();
    if (state_due) {
      state = desk_.State();
    }
  };
  if (!between_.Do(visit, kStepPatience)) {
    return;
  }
  server_->SetTime(truth.stamp_ns);
  if (truth.stamp_ns >= next_bench_ns_) {
    next_bench_ns_ = truth.stamp_ns + kBenchPeriodNs;
    ShowBench(truth);
  }
  if (state_due) {
    state_due_ = false;
    next_state_ = Clock::now() + kServedStatePeriod;
    ShowState(std::move(state));
  }
}

void ServedPage::ShowBench(const Truth& truth) {
  const bool has_target = about_.scene.has_eye;
  if (has_target && feed_->Wants(log::kTruthTopic)) {
    Show(log::kTruthTopic, truth.stamp_ns, log::TruthMessage(TruthSampleOf(about_, truth)));
  }
  if (feed_->Wants(log::kTransformTopic) && truth.q.allFinite()) {
    log::SetTransforms(truth.stamp_ns, facts_.servo.arm, facts_.frames, truth.q,
                       has_target ? std::optional(TargetOf(truth)) : std::nullopt, transforms_);
    Show(log::kTransformTopic, truth.stamp_ns, transforms_);
  }
}

void ServedPage::ShowState(live::State state) {
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
