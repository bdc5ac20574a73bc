// SPDX-License-Identifier: Apache-2.0
// The MCAP container: all written data is read back, wherever the file ends.
#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>

#include "firmware/host/recording/log/log_format.hpp"
#include "firmware/host/recording/log/mcap_reader.hpp"
#include "firmware/host/recording/log/mcap_writer.hpp"
#include "tests/support/temp_folder.hpp"

namespace fovea::log {
namespace {

namespace fs = std::filesystem;

struct Line {
  std::string topic;
  std::int64_t time_ns = 0;
  std::string data;
  bool operator==(const Line&) const = default;
};

struct Content {
  std::vector<Line> messages;
  std::map<std::string, std::string> attachments;
  std::map<std::string, std::map<std::string, std::string>> metadata;
  McapEnd end;
};

Content Read(const fs::path& path) {
  Content content;
  McapVisitor visitor;
  visitor.on_message = [&](const McapMessage& m) {
    content.messages.push_back({std::string(m.topic), m.time_ns, std::string(m.data)});
  };
  visitor.on_attachment = [&](const McapAttachment& a) {
    content.attachments[std::string(a.name)] = std::string(a.data);
  };
  visitor.on_metadata = [&](std::string_view name, const std::map<std::string, std::string>& entries) {
    content.metadata[std::string(name)] = entries;
  };
  content.end = ReadMcap(path, visitor);
  return content;
}

std::string FileBytes(const fs::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

class McapTest : public testing::Test {
 protected:
  // A file of several chunks with every kind of record.
  void WriteSample() {
    McapWriter writer(path_, "test");
    const std::uint16_t schema = writer.AddSchema("a.Type", "descriptor");
    const std::uint16_t first = writer.AddChannel(schema, "/first");
    const std::uint16_t second = writer.AddChannel(schema, "/second");
    std::mt19937 random(7);
    for (int i = 0; i < 300; ++i) {
      std::string data(random() % 200, '\0');
      for (char& c : data) {
        c = static_cast<char>(random() % 256);
      }
      const bool is_first = random() % 2 == 0;
      const std::int64_t time = 1000 * i - static_cast<std::int64_t>(random() % 5000);  // not in order
      writer.Write(is_first ? first : second, time, data);
      written_.push_back({is_first ? "/first" : "/second", std::max<std::int64_t>(time, 0), data});
      if (i % 60 == 59) {
        writer.Flush();
      }
    }
    writer.WriteMetadata("about", {{"key", "value"}, {"", ""}});
    writer.WriteAttachment("film", "video/mp4", 5, std::string("\0\1\2", 3));
    writer.Finish();
  }

  const test::TempFolder folder_;
  const fs::path path_ = folder_.path() / "log.mcap";
  std::vector<Line> written_;
};

TEST_F(McapTest, ReadsBackEverythingWritten) {
  WriteSample();
  const Content content = Read(path_);
  EXPECT_TRUE(content.end.complete) << content.end.why;
  EXPECT_EQ(content.messages, written_);
  EXPECT_EQ(content.attachments.at("film"), std::string("\0\1\2", 3));
  EXPECT_EQ(content.metadata.at("about").at("key"), "value");
}

// Truncated anywhere, the file gives the messages of all complete chunks and is reported as truncated.
TEST_F(McapTest, IsReadableUpToAnyCut) {
  WriteSample();
  const std::string bytes = FileBytes(path_);
  std::size_t most = 0;
  for (std::size_t size = 8; size + 8 < bytes.size(); size += 97) {
    fs::resize_file(path_, size);
    const Content content = Read(path_);
    ASSERT_LE(content.messages.size(), written_.size());
    for (std::size_t i = 0; i < content.messages.size(); ++i) {
      ASSERT_EQ(content.messages[i], written_[i]);
    }
    most = std::max(most, content.messages.size());
    ASSERT_FALSE(content.end.complete) << "cut at byte " << size << " of " << bytes.size();
    ASSERT_NE(content.end.why.find(path_.string()), std::string::npos);
    std::ofstream(path_, std::ios::binary) << bytes;
  }
  EXPECT_EQ(most, written_.size());
}

// A flipped bit in a chunk is detected, and no such damage crashes the reader.
TEST_F(McapTest, DamagedChunkMakesTheLogIncomplete) {
  WriteSample();
  const std::string bytes = FileBytes(path_);
  std::mt19937 random(11);
  int noticed = 0;
  constexpr int kTries = 400;
  for (int i = 0; i < kTries; ++i) {
    std::string damaged = bytes;
    damaged[8 + random() % (bytes.size() - 8)] ^= static_cast<char>(1U << (random() % 8));
    std::ofstream(path_, std::ios::binary) << damaged;
    const Content content = Read(path_);
    noticed += content.end.complete ? 0 : 1;
    // A chunk is read only with a correct checksum.
    if (content.messages != written_) {
      EXPECT_FALSE(content.end.complete) << "damage at try " << i << " was not noticed";
    }
  }
  // Undetected flips lie in names, times or the index, which have no checksum in a sequential read.
  EXPECT_GT(noticed, kTries * 8 / 10);
}

// A chunk with a damaged record type is skipped. The message count of the summary reveals it.
TEST_F(McapTest, SkippedChunkMakesTheLogIncomplete) {
  WriteSample();
  std::string bytes = FileBytes(path_);
  const std::size_t header = 8;
  std::uint64_t length = 0;
  std::memcpy(&length, bytes.data() + header + 1, sizeof length);
  const std::size_t chunk = header + 9 + length;
  ASSERT_EQ(bytes[chunk], 0x06) << "the first chunk follows the header";
  bytes[chunk] = 0x7F;  // a record that later versions may add
  std::ofstream(path_, std::ios::binary) << bytes;
  const Content content = Read(path_);
  EXPECT_FALSE(content.end.complete);
}

TEST_F(McapTest, RefusesAFileThatIsNoLog) {
  std::ofstream(path_) << "not a log at all";
  EXPECT_THROW(Read(path_), std::runtime_error);
  fs::remove(path_);
  EXPECT_THROW(Read(path_), std::runtime_error);
  EXPECT_THROW(Read(fs::temp_directory_path()), std::runtime_error);
}

// The error names both versions, of the log and of the program, and the program that wrote the log.
TEST_F(McapTest, RefusesAnUnknownFormatAndNamesBothVersions) {
  const auto error = [this](const std::string& version) -> std::string {
    {
      McapWriter writer(path_, "test");
      std::map<std::string, std::string> entries = FormatEntries("fovea 9.9.9");
      entries["version"] = version;
      writer.WriteMetadata(kFormatRecord, entries);
      writer.Finish();
    }
    try {
      Read(path_);
    } catch (const std::runtime_error& e) {
      return e.what();
    }
    return "read";
  };
  EXPECT_EQ(error(std::to_string(kOldestLogFormat)), "read");
  EXPECT_EQ(error(std::to_string(kLogFormat)), "read");
  for (const std::string& version :
       {std::to_string(kLogFormat + 1), std::string("0"), std::string("2x"), std::string("")}) {
    EXPECT_EQ(error(version), path_.string() + ": a log of format \"" + version +
                                  "\", written by \"fovea 9.9.9\"; this program reads formats " +
                                  std::to_string(kOldestLogFormat) + " to " + std::to_string(kLogFormat));
  }
}

TEST_F(McapTest, FullDiskThrows) {
  if (!fs::exists("/dev/full")) {
    GTEST_SKIP() << "this system has no /dev/full";
  }
  EXPECT_THROW(
      {
        McapWriter writer("/dev/full", "test");
        const std::uint16_t channel = writer.AddChannel(writer.AddSchema("a.Type", ""), "/first");
        writer.Write(channel, 0, std::string(100'000, 'x'));
        writer.Flush();
        writer.Finish();
      },
      std::runtime_error);
  EXPECT_THROW(McapWriter("/nowhere/at/all", "test"), std::runtime_error);
}

// A chunk of a few bytes that claims 2 GB uncompressed must not cause an allocation.
TEST_F(McapTest, ImplausibleUncompressedSizeIsDamage) {
  const auto put = [](std::string& out, auto value) {
    char bytes[sizeof value];
    std::memcpy(bytes, &value, sizeof value);
    out.append(bytes, sizeof value);
  };
  std::string chunk;
  put(chunk, std::uint64_t{0});
  put(chunk, std::uint64_t{0});
  put(chunk, (std::uint64_t{1} << 31U) - 1U);  // uncompressed size
  put(chunk, std::uint32_t{0});
  put(chunk, std::uint32_t{4});
  chunk += "zstd";
  put(chunk, std::uint64_t{8});
  chunk.append(8, 'x');
  std::string file{"\x89MCAP0\r\n", 8};
  file += '\x06';
  put(file, std::uint64_t{chunk.size()});
  std::ofstream(path_, std::ios::binary) << file + chunk;
  const Content content = Read(path_);
  EXPECT_FALSE(content.end.complete);
  EXPECT_NE(content.end.why.find("impossible size"), std::string::npos) << content.end.why;
}

}  // namespace
}  // namespace fovea::log
