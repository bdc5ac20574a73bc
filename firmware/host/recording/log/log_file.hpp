// SPDX-License-Identifier: Apache-2.0
// An MCAP file of protobuf messages. Adds each type's schema and each topic's channel at its first use.
#pragma once

#include <google/protobuf/message.h>

#include <map>
#include <string>
#include <string_view>
#include <utility>

#include "firmware/host/recording/log/log_tap.hpp"
#include "firmware/host/recording/log/mcap_writer.hpp"

namespace fovea::log {

// A serialised google.protobuf.FileDescriptorSet: the file of `type` and all that it imports.
std::string DescriptorSetOf(const google::protobuf::Descriptor& type);

class LogFile {
 public:
  LogFile(const std::filesystem::path& path, const std::string& library, LogTap tap = {})
      : writer_(path, library), tap_(std::move(tap)) {}

  void Write(const std::string& topic, std::int64_t time_ns, const google::protobuf::Message& message) {
    message.SerializeToString(&bytes_);
    Write(topic, *message.GetDescriptor(), time_ns, bytes_);
  }
  // `bytes`: a serialised message of the given type.
  void Write(const std::string& topic, const google::protobuf::Descriptor& type, std::int64_t time_ns,
             std::string_view bytes);
  // From now on Write only passes the messages to the tap.
  void StopWriting() { is_writing_ = false; }
  McapWriter& writer() { return writer_; }

 private:
  McapWriter writer_;
  LogTap tap_;
  bool is_writing_ = true;
  std::map<std::string, std::uint16_t> schemas_;   // by the type's name
  std::map<std::string, std::uint16_t> channels_;  // by topic
  std::string bytes_;
};

}  // namespace fovea::log
