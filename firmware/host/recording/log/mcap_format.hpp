// SPDX-License-Identifier: Apache-2.0
// Numbers and texts as MCAP writes them: little-endian, lengths before contents.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <map>
#include <stdexcept>
#include <string>
#include <string_view>

namespace fovea::log::mcap {

static_assert(std::endian::native == std::endian::little,
              "the log's numbers are copied as they lie in memory");

inline constexpr std::string_view kMagic{"\x89MCAP0\r\n", 8};

enum class Op : std::uint8_t {
  kHeader = 0x01,
  kFooter = 0x02,
  kSchema = 0x03,
  kChannel = 0x04,
  kMessage = 0x05,
  kChunk = 0x06,
  kMessageIndex = 0x07,
  kChunkIndex = 0x08,
  kAttachment = 0x09,
  kAttachmentIndex = 0x0A,
  kStatistics = 0x0B,
  kMetadata = 0x0C,
  kMetadataIndex = 0x0D,
  kSummaryOffset = 0x0E,
  kDataEnd = 0x0F,
};

template <typename T>
void PutNumber(std::string& out, T value) {
  char bytes[sizeof(T)];
  std::memcpy(bytes, &value, sizeof(T));
  out.append(bytes, sizeof(T));
}

template <typename Length>
void PutBytes(std::string& out, std::string_view bytes) {
  PutNumber(out, static_cast<Length>(bytes.size()));
  out.append(bytes);
}

inline void PutText(std::string& out, std::string_view text) { PutBytes<std::uint32_t>(out, text); }

inline void PutMap(std::string& out, const std::map<std::string, std::string>& entries) {
  std::string body;
  for (const auto& [key, value] : entries) {
    PutText(body, key);
    PutText(body, value);
  }
  PutText(out, body);
}

inline std::string Record(Op op, std::string_view content) {
  std::string record;
  record.reserve(content.size() + 9);
  PutNumber(record, static_cast<std::uint8_t>(op));
  PutBytes<std::uint64_t>(record, content);
  return record;
}

// Reads numbers and texts from the front of a record. std::runtime_error when the record is too short.
class Cursor {
 public:
  explicit Cursor(std::string_view bytes) : rest_(bytes) {}

  std::string_view Bytes(std::uint64_t count) {
    if (count > rest_.size()) {
      throw std::runtime_error("a record is shorter than its length");
    }
    const std::string_view bytes = rest_.substr(0, count);
    rest_.remove_prefix(count);
    return bytes;
  }
  template <typename T>
  T Number() {
    T value{};
    std::memcpy(&value, Bytes(sizeof(T)).data(), sizeof(T));
    return value;
  }
  std::string_view Text() { return Bytes(Number<std::uint32_t>()); }
  std::map<std::string, std::string> Map() {
    std::map<std::string, std::string> entries;
    for (Cursor body(Text()); !body.empty();) {
      const std::string key(body.Text());
      entries[key] = std::string(body.Text());
    }
    return entries;
  }
  std::string_view Rest() { return Bytes(rest_.size()); }
  [[nodiscard]] bool empty() const { return rest_.empty(); }

 private:
  std::string_view rest_;
};

}  // namespace fovea::log::mcap
