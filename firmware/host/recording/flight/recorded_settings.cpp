// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/recording/flight/recorded_settings.hpp"

#include "firmware/host/recording/log/mcap_reader.hpp"
#include "firmware/host/recording/log/topics.hpp"
#include "foxglove/image.pb.h"

namespace fovea::flight {

RecordedSettings ReadSettings(const std::filesystem::path& log) {
  RecordedSettings recorded;
  log::McapVisitor visitor;
  visitor.on_metadata = [&](std::string_view name, const std::map<std::string, std::string>& entries) {
    if (name == "configuration") {
      recorded.keys = entries;
    }
  };
  visitor.on_message = [&](const log::McapMessage& message) {
    foxglove::CameraCalibration camera;
    constexpr int kEntries = 9;  // of its matrix
    if (message.topic == log::kCalibrationTopic &&
        camera.ParseFromArray(message.data.data(), static_cast<int>(message.data.size())) &&
        camera.k_size() == kEntries) {
      recorded.camera = {static_cast<int>(camera.width()),
                         static_cast<int>(camera.height()),
                         camera.k(0),
                         camera.k(4),
                         camera.k(2),
                         camera.k(5)};
    }
  };
  log::ReadMcap(log, visitor);
  return recorded;
}

}  // namespace fovea::flight
