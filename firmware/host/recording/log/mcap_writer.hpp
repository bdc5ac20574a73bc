// SPDX-License-Identifier: Apache-2.0
// Writes MCAP files (mcap.dev/spec, version 0): chunks compressed by Zstandard, indexed, with checksums.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace fovea::log {

// One thread uses it. Every function throws std::runtime_error, naming the file, when it cannot be written.
class McapWriter {
 public:
  // Creates the file. `library` names the writing program in it.
  McapWriter(const std::filesystem::path& path, const std::string& library);
  // An unfinished file stays readable up to the last chunk.
  ~McapWriter() = default;
  McapWriter(const McapWriter&) = delete;
  McapWriter& operator=(const McapWriter&) = delete;

  // A message type: its name, and a serialised google.protobuf.FileDescriptorSet. Returns its number.
  std::uint16_t AddSchema(const std::string& name, const std::string& descriptor_set);
  // A stream of messages of one type. Returns its number.
  std::uint16_t AddChannel(std::uint16_t schema, const std::string& topic);

  // `time_ns` [>= 0] need not ascend.
  void Write(std::uint16_t channel, std::int64_t time_ns, std::string_view message);

  void WriteAttachment(const std::string& name, const std::string& media_type, std::int64_t time_ns,
                       std::string_view content);
  void WriteMetadata(const std::string& name, const std::map<std::string, std::string>& entries);

  // Writes the collected messages to the file, so that a reader sees them.
  void Flush();
  // Completes the file; nothing may be written after it.
  void Finish();

 private:
  struct Channel {
    std::uint16_t schema = 0;
    std::uint64_t messages = 0;
    std::string index;  // of the open chunk: (time, offset) of each message
  };
  struct Span {
    std::uint64_t first_ns = 0;
    std::uint64_t last_ns = 0;
    bool empty = true;
    void Add(std::uint64_t time_ns);
  };

  void Put(std::string_view bytes);
  void CloseChunk();
  std::string Summary(std::uint64_t start) const;

  const std::filesystem::path path_;
  std::ofstream file_;
  std::uint64_t position_ = 0;  // in the file

  std::vector<std::string> schemas_;          // records as they were written
  std::vector<std::string> channel_records_;  // records as they were written
  std::vector<Channel> channels_;             // number 0 first
  std::vector<std::string> chunk_indexes_;    // records for the summary
  std::vector<std::string> attachment_indexes_;
  std::vector<std::string> metadata_indexes_;
  std::uint64_t messages_ = 0;
  Span span_;

  std::string chunk_;  // records of the open chunk
  Span chunk_span_;
  std::string compressed_;
};

}  // namespace fovea::log
