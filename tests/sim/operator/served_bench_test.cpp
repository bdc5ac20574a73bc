// SPDX-License-Identifier: Apache-2.0
// A viewer touches the bench of a served robot. No client is connected: the robot holds its position.
#include <gtest/gtest.h>

#include <fstream>
#include <iostream>
#include <optional>
#include <set>
#include <thread>

#include "firmware/host/recording/log/topics.hpp"
#include "fovea/run.pb.h"
#include "foxglove/geometry.pb.h"
#include "foxglove/image.pb.h"
#include "sim/operator/served_desk.hpp"
#include "sim/operator/served_page.hpp"
#include "sim/panda/robot.hpp"
#include "sim/scenario/run_description.hpp"
#include "sim/scenario/world_config.hpp"
#include "tests/host/live/live_client.hpp"
#include "tests/support/input_error.hpp"
#include "tests/support/temp_folder.hpp"

namespace fovea::sim {
namespace {

using nlohmann::json;

WorldConfig LoadableWorld(const RunDescription& about) {
  WorldConfig config = MakeWorldConfig(about);
  config.physics.may_be_loaded = true;
  return config;
}

struct ServedBench {
  // Steps the robot, as FciServer does, and calls `after_step`.
  template <class AfterStep>
  void Step(int steps, const AfterStep& after_step) {
    for (int i = 0; i < steps; ++i) {
      robot.Step(std::nullopt);
      after_step();
    }
  }
  [[nodiscard]] std::string hand() const {
    return about.scene.robot.links[static_cast<std::size_t>(about.scene.robot.tip)].name;
  }
  [[nodiscard]] Eigen::Vector3d p_BE() const { return world.truth().X_BE.translation(); }

  const RunDescription about = DescribeRun(LoadScenario("ball", {}));
  World world{LoadableWorld(about)};
  FciRobot robot{world, about.scene.robot};
};

class ServedDeskTest : public testing::Test {
 protected:
  std::string Ask(const live::Request& request) { return desk_.Do({"somebody", request}).error; }
  void Step(int steps) {
    bench_.Step(steps, [this] { desk_.Act(); });
  }
  live::State State() const { return desk_.State(desk_.Look()); }
  std::size_t Fault(const std::string& name) const {
    const live::Catalogue offer = ServedDesk::Offer(bench_.about);
    for (std::size_t i = 0; i < offer.faults.size(); ++i) {
      if (offer.faults[i].name == name) {
        return i;
      }
    }
    throw std::logic_error("no fault " + name);
  }

  ServedBench bench_;
  std::vector<FaultSettings> camera_faults_;
  ServedDesk desk_{bench_.about, bench_.world,
                   [this](const FaultSettings& faults) { camera_faults_.push_back(faults); }};
};

TEST_F(ServedDeskTest, ADragMovesTheTarget) {
  Step(10);
  const Eigen::Vector3d from = bench_.world.truth().p_BO;
  EXPECT_EQ(Ask(live::HoldTarget{{from.x(), from.y() + 0.1, from.z()}}), "");
  EXPECT_TRUE(State().target->held);
  Step(2000);
  EXPECT_NEAR((bench_.world.truth().p_BO - from).norm(), 0.1, 1e-9);
  EXPECT_EQ(Ask(live::ReleaseTarget{}), "");
  EXPECT_FALSE(State().target->held);
  EXPECT_NE(Ask(live::HoldTarget{{2.1, 0.0, 0.04}}), "") << "out of reach";
  EXPECT_EQ(Ask(live::Throw{{0.0, 0.5, 0.0}, {}}), "");
  Step(100);
  EXPECT_GT((bench_.world.truth().p_BO - from).norm(), 0.12);
}

TEST_F(ServedDeskTest, APullLoadsTheArmUntilItsEnd) {
  Step(200);
  const Eigen::Vector3d rest = bench_.p_BE();
  EXPECT_EQ(Ask(live::Pull{bench_.hand(), {}, {rest.x(), rest.y() + 0.1, rest.z()}}), "");
  EXPECT_EQ(State().pull->link, bench_.hand());
  Step(500);
  const double pulled = bench_.p_BE().y() - rest.y();
  std::cout << "a spring of 20 N moves the hand of the served robot by " << 1e3 * pulled << " mm\n";
  EXPECT_GT(pulled, 1e-4);
  EXPECT_EQ(Ask(live::ControlEnded{}), "");
  EXPECT_FALSE(State().pull.has_value());
  Step(1000);
  EXPECT_LT(std::abs(bench_.p_BE().y() - rest.y()), 0.5 * pulled) << "the robot's impedance brings it back";
  EXPECT_EQ(Ask(live::Pull{"no_such_link", {}, {}}), "the arm has no link \"no_such_link\"");
}

TEST_F(ServedDeskTest, AFaultOfTheBenchStartsAndStops) {
  const std::size_t load = Fault("load");
  Step(200);
  const double rest = bench_.p_BE().z();
  EXPECT_EQ(Ask(live::StartFault{load, {{"load_mass", 2.0}}}), "");
  Step(300);
  EXPECT_TRUE(State().faults[load].active);
  const double sag = rest - bench_.p_BE().z();
  std::cout << "a load of 2 kg lowers the hand of the served robot by " << 1e3 * sag << " mm\n";
  EXPECT_GT(sag, 1e-4);
  EXPECT_EQ(Ask(live::StopFault{load}), "");
  Step(1000);
  EXPECT_FALSE(State().faults[load].active);
  EXPECT_LT(std::abs(rest - bench_.p_BE().z()), 0.5 * sag);
}

TEST_F(ServedDeskTest, TheCameraGetsItsFaults) {
  EXPECT_EQ(Ask(live::StartFault{Fault("mirror"), {}}), "");
  ASSERT_EQ(camera_faults_.size(), 1U);
  EXPECT_TRUE(camera_faults_[0].picture.mirror.Contains(bench_.world.now_ns() + hal::kTickPeriodNs))
      << "from the next step on";
}

TEST_F(ServedDeskTest, ARefusedFaultSaysWhyAndChangesNothing) {
  EXPECT_EQ(Ask(live::StartFault{Fault("push"), {}}),
            "faults.push is 0 for each joint: give at least one of them a torque");
  EXPECT_FALSE(State().faults[Fault("push")].active);
  EXPECT_NE(Ask(live::StartFault{Fault("load"), {{"load_mass", 1000.0}}}), "");
  EXPECT_TRUE(camera_faults_.empty());
  EXPECT_EQ(Ask(live::Track{}), "a served robot does not offer this");
}

TEST_F(ServedDeskTest, OffersTheFaultsThatServeAccepts) {
  const int joints = bench_.about.robot.model.num_joints;
  std::set<std::string> offered;
  for (const live::FaultKind& kind : ServedDesk::Offer(bench_.about).faults) {
    offered.insert(kind.name);
  }
  std::size_t accepted = 0;
  for (const FaultSwitch& fault : FaultPanel({}, joints).Switches(0.0)) {
    FaultPanel panel({}, joints);
    panel.Start(fault.name,
                fault.name == "push" ? std::map<std::string, double>{{"push[1]", 1.0}}
                                     : std::map<std::string, double>{},
                0.0);
    const bool is_accepted = test::InputErrorOf([&] { CheckServedFaults(panel.faults()); }).empty();
    accepted += is_accepted ? 1U : 0U;
    EXPECT_EQ(offered.contains(fault.name), is_accepted) << fault.name;
  }
  EXPECT_EQ(offered.size(), accepted);
  EXPECT_GT(accepted, 8U);
}

class ServedPageTest : public testing::Test {
 protected:
  static constexpr const char* kTarget = "/?token=test-token";

  ServedPageTest() {
    std::ofstream(folder_.path() / "index.html") << "<p>page</p>";
    live::ServerConfig config;
    config.page = folder_.path();
    config.port = 0;
    config.token = "test-token";
    page_.emplace(config, bench_.about, bench_.world, ServedDesk::CameraFaults());
    const std::string url = page_->url();
    port_ = static_cast<std::uint16_t>(std::stoi(url.substr(url.rfind(':') + 1)));
    GoOn();
  }
  ~ServedPageTest() override { Stop(); }
  void GoOn() {
    stop_ = false;
    thread_ = std::thread([this] {
      while (!stop_) {
        bench_.Step(1, [this] { page_->AfterStep(); });
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
      }
    });
  }
  void Stop() {
    stop_ = true;
    if (thread_.joinable()) {
      thread_.join();
    }
  }
  // An open viewer; knows the ids of the channels.
  std::unique_ptr<test::LiveClient> Viewer() {
    auto client = std::make_unique<test::LiveClient>(port_);
    EXPECT_EQ(client->Open(kTarget).status, 101);
    const json channels = client->Await("op", "advertise")["channels"];
    for (const json& channel : channels) {
      ids_[channel["topic"]] = channel["id"];
    }
    return client;
  }
  void Subscribe(const test::LiveClient& client, const std::string& topic) {
    const int id = ids_.at(topic);
    client.SendText({{"op", "subscribe"}, {"subscriptions", {{{"id", id}, {"channelId", id}}}}});
  }
  // The payload of the next message of the topic.
  std::string Next(test::LiveClient& client, const std::string& topic) {
    while (true) {
      const json message = client.Await("binary", 1);
      if (message.is_null()) {
        ADD_FAILURE() << "no message of " << topic;
        return "";
      }
      if (message["subscription"] == ids_.at(topic)) {
        return message["payload"];
      }
    }
  }
  template <class Message>
  Message NextOf(test::LiveClient& client, const std::string& topic) {
    Message message;
    EXPECT_TRUE(message.ParseFromString(Next(client, topic)));
    return message;
  }
  // The first of the next states that is as `wanted`; the last of many if none is.
  template <class Wanted>
  json AwaitState(test::LiveClient& client, const Wanted& wanted) {
    json state;
    for (int i = 0; i < 100 && (i == 0 || !wanted(state)); ++i) {
      state = json::parse(Next(client, "/live/state"));
    }
    return state;
  }
  static std::string Call(live::Service service, std::uint32_t call, const json& request) {
    return test::BinaryServiceCall(1 + static_cast<std::uint32_t>(service), call, request.dump());
  }

  const test::TempFolder folder_;
  ServedBench bench_;
  std::optional<ServedPage> page_;
  std::uint16_t port_ = 0;
  std::map<std::string, int> ids_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

TEST_F(ServedPageTest, AViewerSeesTheBench) {
  const auto client = Viewer();
  for (const char* topic : {log::kTickTopic, log::kEventTopic, log::kAnnotationTopic}) {
    EXPECT_FALSE(ids_.contains(topic)) << topic << " is the client's";
  }
  Subscribe(*client, log::kSetupTopic);
  const auto setup = NextOf<log::Setup>(*client, log::kSetupTopic);
  EXPECT_EQ(setup.name(), bench_.about.scenario.name);
  EXPECT_EQ(setup.joints_size(), 7);
  EXPECT_EQ(setup.duration_s(), 0.0);
  Subscribe(*client, log::kTruthTopic);
  const auto first = NextOf<log::Truth>(*client, log::kTruthTopic);
  const auto second = NextOf<log::Truth>(*client, log::kTruthTopic);
  EXPECT_GE(second.stamp_ns() - first.stamp_ns(), 16'000'000) << "60 Hz at most";
  EXPECT_GT(first.error_px(), 0.0);
  Subscribe(*client, log::kTransformTopic);
  const auto poses = NextOf<foxglove::FrameTransforms>(*client, log::kTransformTopic);
  std::set<std::string> frames;
  for (const auto& pose : poses.transforms()) {
    frames.insert(pose.child_frame_id());
  }
  EXPECT_TRUE(frames.contains(bench_.hand()));
  EXPECT_TRUE(frames.contains(log::kCameraFrame));
  EXPECT_TRUE(frames.contains(log::kTargetFrame));
}

TEST_F(ServedPageTest, AViewerSeesThePicturesOfTheCamera) {
  const auto client = Viewer();
  const std::vector<std::uint8_t> pixels(64 * 48 * 3, 128);
  hal::Frame frame;
  frame.stamp_ns = 5'000'000'000;
  frame.width_px = 64;
  frame.height_px = 48;
  frame.stride_bytes = 64 * 3;
  frame.pixels = pixels;
  page_->AddPicture(frame);  // nobody watches: dropped
  Subscribe(*client, log::kImageTopic);
  std::atomic<bool> seen{false};
  std::thread camera([&] {
    while (!seen) {
      page_->AddPicture(frame);
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
  });
  const auto image = NextOf<foxglove::CompressedImage>(*client, log::kImageTopic);
  seen = true;
  camera.join();
  EXPECT_EQ(image.timestamp().seconds(), 5);
  EXPECT_EQ(image.format(), "jpeg");
  EXPECT_EQ(image.data().substr(0, 2), "\xFF\xD8");
}

TEST_F(ServedPageTest, AViewerPullsTheArmAndEndsTheServing) {
  const auto client = Viewer();
  const json pull{{"link", bench_.hand()}, {"p_link", {0, 0, 0}}, {"to_B", {0.5, 0.1, 0.5}}};
  client->SendBinary(Call(live::Service::kPull, 1, pull));
  EXPECT_EQ(client->Await("binary", 3)["call"], 1);
  client->SendBinary(Call(live::Service::kStartFault, 2, {{"name", "push"}}));
  const json refused = client->Await("op", "serviceCallFailure");
  EXPECT_NE(std::string(refused["message"]).find("give at least one of them a torque"), std::string::npos);
  EXPECT_FALSE(page_->ended());
  Subscribe(*client, "/live/state");
  const json state = json::parse(Next(*client, "/live/state"));
  EXPECT_EQ(state["mode"], "");
  EXPECT_EQ(state["may"]["pause"], false);
  EXPECT_EQ(state["may"]["pull"], true);
  client->SendBinary(Call(live::Service::kEnd, 3, json::object()));
  EXPECT_EQ(client->Await("binary", 3)["call"], 3);
  EXPECT_TRUE(page_->ended());
}

// The server answers in time, whatever the world does.
TEST_F(ServedPageTest, ARobotThatStandsStillRefusesWithTheReason) {
  const auto client = Viewer();
  Stop();
  const json pull{{"link", bench_.hand()}, {"p_link", {0, 0, 0}}, {"to_B", {0.5, 0.1, 0.5}}};
  client->SendBinary(Call(live::Service::kPull, 7, pull));
  const json refused = client->Await("op", "serviceCallFailure");
  EXPECT_NE(std::string(refused["message"]).find("stands still"), std::string::npos);
  Subscribe(*client, "/live/state");
  const json state = AwaitState(*client, [](const json& each) { return each["notice"] != ""; });
  EXPECT_NE(std::string(state["notice"]).find("the robot does not step"), std::string::npos) << state;
  EXPECT_EQ(state["real_time_factor"], 0.0);
}

// Otherwise the spring would pull for ever.
TEST_F(ServedPageTest, ALetGoIsKeptUntilTheRobotStepsAgain) {
  const auto client = Viewer();
  const json pull{{"link", bench_.hand()}, {"p_link", {0, 0, 0}}, {"to_B", {0.5, 0.1, 0.5}}};
  client->SendBinary(Call(live::Service::kPull, 1, pull));
  EXPECT_EQ(client->Await("binary", 3)["call"], 1);
  Subscribe(*client, "/live/state");
  const json pulled = AwaitState(*client, [](const json& state) { return state["pull"] != nullptr; });
  EXPECT_EQ(pulled["pull"]["link"], bench_.hand());
  Stop();
  client->SendBinary(Call(live::Service::kRelease, 2, json::object()));
  EXPECT_EQ(client->Await("binary", 3)["call"], 2) << "it is not refused";
  GoOn();
  const json free = AwaitState(*client, [](const json& state) { return state["pull"] == nullptr; });
  EXPECT_EQ(free["pull"], nullptr);
}

}  // namespace
}  // namespace fovea::sim
