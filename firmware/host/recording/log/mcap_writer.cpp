// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/recording/log/mcap_writer.hpp"

#include <fmt/format.h>
#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <cerrno>

#include "firmware/host/recording/log/mcap_format.hpp"

namespace fovea::log {

using mcap::Op;
using mcap::PutBytes;
using mcap::PutMap;
using mcap::PutNumber;
using mcap::PutText;

namespace {

constexpr std::size_t kChunkBytes = 1U << 20U;  // a chunk of this size is closed
constexpr int kZstdLevel = 1;  // pictures are compressed already, numbers shrink at any level

std::uint32_t Crc(std::string_view bytes, std::uint32_t before = 0) {
  return static_cast<std::uint32_t>(
      crc32_z(before, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

}  // namespace

void McapWriter::Span::Add(std::uint64_t time_ns) {
  first_ns = empty ? time_ns : std::min(first_ns, time_ns);
  last_ns = empty ? time_ns : std::max(last_ns, time_ns);
  empty = false;
}

McapWriter::McapWriter(const std::filesystem::path& path, const std::string& library)
    : path_(path), file_(path, std::ios::binary | std::ios::trunc) {
  std::string header;
  PutText(header, "");  // no profile
  PutText(header, library);
  Put(mcap::kMagic);
  Put(mcap::Record(Op::kHeader, header));
  file_.flush();  // a reader finds a log from now on; the next Put reports an error
}

void McapWriter::Put(std::string_view bytes) {
  file_.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (!file_) {
    throw std::runtime_error(
        fmt::format("{}: cannot be written: {}", path_.string(), std::generic_category().message(errno)));
  }
  position_ += bytes.size();
}

std::uint16_t McapWriter::AddSchema(const std::string& name, const std::string& descriptor_set) {
  const auto id = static_cast<std::uint16_t>(schemas_.size() + 1);  // 0 stands for no schema
  std::string content;
  PutNumber(content, id);
  PutText(content, name);
  PutText(content, "protobuf");
  PutText(content, descriptor_set);
  schemas_.push_back(mcap::Record(Op::kSchema, content));
  chunk_ += schemas_.back();
  return id;
}

std::uint16_t McapWriter::AddChannel(std::uint16_t schema, const std::string& topic) {
  const auto id = static_cast<std::uint16_t>(channels_.size());
  std::string content;
  PutNumber(content, id);
  PutNumber(content, schema);
  PutText(content, topic);
  PutText(content, "protobuf");
  PutMap(content, {});
  channel_records_.push_back(mcap::Record(Op::kChannel, content));
  chunk_ += channel_records_.back();
  channels_.push_back({schema, 0, {}});
  return id;
}

void McapWriter::Write(std::uint16_t channel, std::int64_t time_ns, std::string_view message) {
  Channel& to = channels_.at(channel);
  const auto time = static_cast<std::uint64_t>(std::max<std::int64_t>(time_ns, 0));
  PutNumber(to.index, time);
  PutNumber(to.index, static_cast<std::uint64_t>(chunk_.size()));
  chunk_span_.Add(time);
  constexpr std::uint64_t kHead = 2 + 4 + 8 + 8;
  PutNumber(chunk_, static_cast<std::uint8_t>(Op::kMessage));
  PutNumber(chunk_, kHead + message.size());
  PutNumber(chunk_, channel);
  PutNumber(chunk_, static_cast<std::uint32_t>(to.messages++));
  PutNumber(chunk_, time);
  PutNumber(chunk_, time);
  chunk_.append(message);
  ++messages_;
  if (chunk_.size() >= kChunkBytes) {
    CloseChunk();
  }
}

void McapWriter::CloseChunk() {
  if (chunk_.empty()) {
    return;
  }
  compressed_.resize(ZSTD_compressBound(chunk_.size()));
  const std::size_t size =
      ZSTD_compress(compressed_.data(), compressed_.size(), chunk_.data(), chunk_.size(), kZstdLevel);
  if (ZSTD_isError(size) != 0) {
    throw std::runtime_error(fmt::format("{}: {}", path_.string(), ZSTD_getErrorName(size)));
  }
  const std::uint64_t chunk_start = position_;
  std::string content;
  content.reserve(size + 64);
  PutNumber(content, chunk_span_.first_ns);
  PutNumber(content, chunk_span_.last_ns);
  PutNumber(content, static_cast<std::uint64_t>(chunk_.size()));
  PutNumber(content, Crc(chunk_));
  PutText(content, "zstd");
  PutBytes<std::uint64_t>(content, std::string_view(compressed_).substr(0, size));
  Put(mcap::Record(Op::kChunk, content));
  const std::uint64_t index_start = position_;

  std::string offsets;  // of each channel's index in the file
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    if (channels_[i].index.empty()) {
      continue;
    }
    PutNumber(offsets, static_cast<std::uint16_t>(i));
    PutNumber(offsets, position_);
    std::string index;
    PutNumber(index, static_cast<std::uint16_t>(i));
    PutText(index, channels_[i].index);
    Put(mcap::Record(Op::kMessageIndex, index));
    channels_[i].index.clear();
  }
  std::string entry;
  PutNumber(entry, chunk_span_.first_ns);
  PutNumber(entry, chunk_span_.last_ns);
  PutNumber(entry, chunk_start);
  PutNumber(entry, index_start - chunk_start);
  PutText(entry, offsets);
  PutNumber(entry, position_ - index_start);
  PutText(entry, "zstd");
  PutNumber(entry, static_cast<std::uint64_t>(size));
  PutNumber(entry, static_cast<std::uint64_t>(chunk_.size()));
  chunk_indexes_.push_back(mcap::Record(Op::kChunkIndex, entry));

  if (!chunk_span_.empty) {
    span_.Add(chunk_span_.first_ns);
    span_.Add(chunk_span_.last_ns);
  }
  chunk_.clear();
  chunk_span_ = {};
}

void McapWriter::WriteAttachment(const std::string& name, const std::string& media_type, std::int64_t time_ns,
                                 std::string_view bytes) {
  const auto time = static_cast<std::uint64_t>(std::max<std::int64_t>(time_ns, 0));
  std::string content;
  content.reserve(bytes.size() + 128);
  PutNumber(content, time);
  PutNumber(content, time);
  PutText(content, name);
  PutText(content, media_type);
  PutBytes<std::uint64_t>(content, bytes);
  PutNumber(content, Crc(content));
  const std::string record = mcap::Record(Op::kAttachment, content);

  std::string entry;
  PutNumber(entry, position_);
  PutNumber(entry, static_cast<std::uint64_t>(record.size()));
  PutNumber(entry, time);
  PutNumber(entry, time);
  PutNumber(entry, static_cast<std::uint64_t>(bytes.size()));
  PutText(entry, name);
  PutText(entry, media_type);
  attachment_indexes_.push_back(mcap::Record(Op::kAttachmentIndex, entry));
  Put(record);
}

void McapWriter::WriteMetadata(const std::string& name, const std::map<std::string, std::string>& entries) {
  std::string content;
  PutText(content, name);
  PutMap(content, entries);
  const std::string record = mcap::Record(Op::kMetadata, content);

  std::string entry;
  PutNumber(entry, position_);
  PutNumber(entry, static_cast<std::uint64_t>(record.size()));
  PutText(entry, name);
  metadata_indexes_.push_back(mcap::Record(Op::kMetadataIndex, entry));
  Put(record);
}

void McapWriter::Flush() {
  CloseChunk();
  file_.flush();
  Put({});  // throws if the flush failed
}

// The summary at the file's end: all that a reader needs for random access, and the offset of each group of
// records in the summary.
std::string McapWriter::Summary(std::uint64_t start) const {
  std::string statistics;
  PutNumber(statistics, messages_);
  PutNumber(statistics, static_cast<std::uint16_t>(schemas_.size()));
  PutNumber(statistics, static_cast<std::uint32_t>(channels_.size()));
  PutNumber(statistics, static_cast<std::uint32_t>(attachment_indexes_.size()));
  PutNumber(statistics, static_cast<std::uint32_t>(metadata_indexes_.size()));
  PutNumber(statistics, static_cast<std::uint32_t>(chunk_indexes_.size()));
  PutNumber(statistics, span_.first_ns);
  PutNumber(statistics, span_.last_ns);
  std::string counts;
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    PutNumber(counts, static_cast<std::uint16_t>(i));
    PutNumber(counts, channels_[i].messages);
  }
  PutText(statistics, counts);

  std::string summary;
  std::string offsets;
  const auto put_group = [&](Op op, const std::vector<std::string>& records) {
    if (records.empty()) {
      return;
    }
    const std::uint64_t group_start = start + summary.size();
    for (const std::string& record : records) {
      summary += record;
    }
    std::string offset;
    PutNumber(offset, static_cast<std::uint8_t>(op));
    PutNumber(offset, group_start);
    PutNumber(offset, start + summary.size() - group_start);
    offsets += mcap::Record(Op::kSummaryOffset, offset);
  };
  put_group(Op::kSchema, schemas_);
  put_group(Op::kChannel, channel_records_);
  put_group(Op::kStatistics, {mcap::Record(Op::kStatistics, statistics)});
  put_group(Op::kChunkIndex, chunk_indexes_);
  put_group(Op::kAttachmentIndex, attachment_indexes_);
  put_group(Op::kMetadataIndex, metadata_indexes_);

  const std::uint64_t offset_start = start + summary.size();
  summary += offsets;
  // The footer's checksum covers the summary and the footer up to the checksum itself.
  constexpr std::uint64_t kFooterBytes = 8 + 8 + 4;
  PutNumber(summary, static_cast<std::uint8_t>(Op::kFooter));
  PutNumber(summary, kFooterBytes);
  PutNumber(summary, start);
  PutNumber(summary, offset_start);
  PutNumber(summary, Crc(summary));
  return summary;
}

void McapWriter::Finish() {
  CloseChunk();
  std::string data_end;
  PutNumber(data_end, std::uint32_t{0});  // no checksum over the file: each chunk has its own
  Put(mcap::Record(Op::kDataEnd, data_end));
  Put(Summary(position_));
  Put(mcap::kMagic);
  file_.close();
  Put({});
}

}  // namespace fovea::log
