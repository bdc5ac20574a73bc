// SPDX-License-Identifier: Apache-2.0
// Reads MCAP files from front to back. Reads a truncated log up to the cut.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <string_view>

namespace fovea::log {

struct McapMessage {
  std::string_view topic;
  std::string_view schema;  // the message type's name
  std::int64_t time_ns = 0;
  std::string_view data;
};

struct McapAttachment {
  std::string_view name;
  std::string_view media_type;
  std::string_view data;
};

// Called in the order of the file; views are valid only during the call. Any function may be empty.
struct McapVisitor {
  std::function<void(const McapMessage&)> on_message;
  std::function<void(const McapAttachment&)> on_attachment;
  std::function<void(std::string_view name, const std::map<std::string, std::string>&)> on_metadata;
};

struct McapEnd {
  bool complete = false;  // the file was finished by its writer, and all its messages were there
  std::string why;        // when not complete: what is wrong, and where
};

// std::runtime_error, naming the file: it cannot be opened, is no MCAP file, or is a log of a format that
// this program does not read (log_format.hpp).
McapEnd ReadMcap(const std::filesystem::path& path, const McapVisitor& visitor);

}  // namespace fovea::log
