// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/live/live_feed.hpp"

#include <google/protobuf/descriptor.h>

#include <utility>

#include "firmware/host/live/server.hpp"
#include "firmware/host/recording/log/base64.hpp"
#include "firmware/host/recording/log/log_file.hpp"
#include "firmware/host/recording/log/topics.hpp"
#include "fovea/run.pb.h"
#include "fovea/tick.pb.h"
#include "foxglove/geometry.pb.h"
#include "foxglove/image.pb.h"
#include "foxglove/log.pb.h"
#include "foxglove/scene.pb.h"

namespace fovea::live {
namespace {

constexpr double kPlotHz = 100.0;  // of wall time: more than any screen shows

}  // namespace

Channel MessageChannel(std::string topic, const google::protobuf::Descriptor& type, Weight weight,
                       bool latched, double most_hz) {
  return {std::move(topic), type.full_name(), log::Base64(log::DescriptorSetOf(type)),
          weight,           latched,          most_hz};
}

std::vector<Channel> LogChannels(const LogContents& contents) {
  constexpr bool kLatched = true;
  const Weight plot = Weight::kPlot;
  const Weight essential = Weight::kEssential;
  std::vector<Channel> channels;
  if (contents.servo) {
    channels = {MessageChannel(log::kTickTopic, *log::Tick::descriptor(), plot, false, kPlotHz),
                MessageChannel(log::kFeatureTopic, *log::Feature::descriptor(), plot),
                MessageChannel(log::kEventTopic, *foxglove::Log::descriptor()),
                MessageChannel(log::kOperatorTopic, *log::Touch::descriptor())};
  }
  channels.push_back(MessageChannel(log::kSetupTopic, *log::Setup::descriptor(), essential, kLatched));
  channels.push_back(MessageChannel(log::kTransformTopic, *foxglove::FrameTransforms::descriptor(), plot));
  channels.push_back(
      MessageChannel(log::kSceneTopic, *foxglove::SceneUpdate::descriptor(), essential, kLatched));
  if (contents.servo && contents.configuration) {
    channels.push_back(MessageChannel(log::kConfigurationTopic, *log::ServoConfiguration::descriptor(),
                                      essential, kLatched));
  }
  if (contents.camera) {
    channels.push_back(
        MessageChannel(log::kImageTopic, *foxglove::CompressedImage::descriptor(), Weight::kPicture));
    if (contents.servo) {
      channels.push_back(
          MessageChannel(log::kAnnotationTopic, *foxglove::ImageAnnotations::descriptor(), plot));
    }
    channels.push_back(MessageChannel(log::kCalibrationTopic, *foxglove::CameraCalibration::descriptor(),
                                      essential, kLatched));
  }
  if (contents.truth) {
    channels.push_back(MessageChannel(log::kTruthTopic, *log::Truth::descriptor(), plot, false, kPlotHz));
  }
  if (contents.theory) {
    channels.push_back(MessageChannel(log::kTheoryTopic, *log::Theory::descriptor(), plot, false, kPlotHz));
  }
  return channels;
}

LiveFeed::LiveFeed(Server& server, const std::vector<Channel>& channels) : server_(server) {
  for (std::size_t i = 0; i < channels.size(); ++i) {
    places_[channels[i].topic] = {i, channels[i].schema_name};
  }
}

void LiveFeed::Take(std::string_view topic, const google::protobuf::Descriptor& type, std::int64_t time_ns,
                    std::string_view bytes) {
  const auto place = places_.find(topic);
  if (place == places_.end() || place->second.type != type.full_name()) {
    return;
  }
  if (topic == log::kTickTopic) {
    server_.SetTime(time_ns);
  }
  if (server_.Wants(place->second.channel)) {
    server_.Publish(place->second.channel, time_ns, std::string(bytes));
  }
}

bool LiveFeed::Wants(std::string_view topic) const {
  const auto place = places_.find(topic);
  return place != places_.end() && server_.Wants(place->second.channel);
}

}  // namespace fovea::live
