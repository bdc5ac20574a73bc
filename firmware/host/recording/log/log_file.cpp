// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/recording/log/log_file.hpp"

#include <google/protobuf/descriptor.h>
#include <google/protobuf/descriptor.pb.h>

#include <set>

namespace fovea::log {
namespace {

using google::protobuf::FileDescriptor;

// Adds `file` after its imports.
void AddFile(const FileDescriptor& file, std::set<std::string>& known,
             google::protobuf::FileDescriptorSet& set) {
  if (!known.insert(file.name()).second) {
    return;
  }
  for (int i = 0; i < file.dependency_count(); ++i) {
    AddFile(*file.dependency(i), known, set);
  }
  file.CopyTo(set.add_file());
}

}  // namespace

std::string DescriptorSetOf(const google::protobuf::Descriptor& type) {
  google::protobuf::FileDescriptorSet set;
  std::set<std::string> known;
  AddFile(*type.file(), known, set);
  return set.SerializeAsString();
}

void LogFile::Write(const std::string& topic, const google::protobuf::Descriptor& type, std::int64_t time_ns,
                    std::string_view bytes) {
  if (tap_) {
    tap_(topic, type, time_ns, bytes);
  }
  if (!is_writing_) {
    return;
  }
  auto channel = channels_.find(topic);
  if (channel == channels_.end()) {
    auto schema = schemas_.find(type.full_name());
    if (schema == schemas_.end()) {
      const std::uint16_t id = writer_.AddSchema(type.full_name(), DescriptorSetOf(type));
      schema = schemas_.emplace(type.full_name(), id).first;
    }
    channel = channels_.emplace(topic, writer_.AddChannel(schema->second, topic)).first;
  }
  writer_.Write(channel->second, time_ns, bytes);
}

}  // namespace fovea::log
