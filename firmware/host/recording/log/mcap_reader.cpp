// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/recording/log/mcap_reader.hpp"

#include <fmt/format.h>
#include <zlib.h>
#include <zstd.h>

#include <fstream>

#include "firmware/host/recording/log/log_format.hpp"
#include "firmware/host/recording/log/mcap_format.hpp"

namespace fovea::log {
namespace {

using mcap::Cursor;
using mcap::Op;

// No writer makes records or chunks so large; a length above it is damage.
constexpr std::uint64_t kMostBytes = std::uint64_t{1} << 31U;

// Zstandard's best ratio: a block of 128 KiB in 4 bytes. A chunk that claims more is damaged; memory for it
// would be wasted.
constexpr std::uint64_t kMostPacked = 32'768;

class Reader {
 public:
  Reader(const std::filesystem::path& path, const McapVisitor& visitor)
      : path_(path), visitor_(visitor), file_(path, std::ios::binary) {}

  McapEnd Read() {
    std::string magic(mcap::kMagic.size(), '\0');
    if (!file_ || std::filesystem::is_directory(path_)) {
      throw std::runtime_error(path_.string() + ": no such file, or it cannot be read");
    }
    if (!file_.read(magic.data(), static_cast<std::streamsize>(magic.size())) || magic != mcap::kMagic) {
      throw std::runtime_error(path_.string() + ": not an MCAP file");
    }
    std::error_code error;
    size_ = std::filesystem::file_size(path_, error);
    std::uint64_t at = magic.size();
    try {
      while (!ended_) {
        at = static_cast<std::uint64_t>(file_.tellg());
        if (!ReadRecord(at)) {
          return {false, fmt::format("{}: cut off at byte {}", path_.string(), at)};
        }
      }
    } catch (const DamageError& damage) {
      return {false, fmt::format("{}: damaged at byte {}: {}", path_.string(), at, damage.what())};
    }
    if (num_messages_ != num_promised_) {
      return {false,
              fmt::format("{}: holds {} of its {} messages", path_.string(), num_messages_, num_promised_)};
    }
    return {true, ""};
  }

 private:
  // Damage of the file. Exceptions of a visitor pass through.
  struct DamageError : std::runtime_error {
    using std::runtime_error::runtime_error;
  };

  bool ReadRecord(std::uint64_t at) {
    char head[9];
    if (!file_.read(head, sizeof head)) {
      return false;
    }
    Cursor cursor(std::string_view(head, sizeof head));
    const auto op = static_cast<Op>(cursor.Number<std::uint8_t>());
    const auto length = cursor.Number<std::uint64_t>();
    if (length > size_ - at - sizeof head) {
      return false;
    }
    if (length > kMostBytes) {
      throw DamageError("a record of impossible length");
    }
    record_.resize(length);
    if (!file_.read(record_.data(), static_cast<std::streamsize>(length))) {
      return false;
    }
    Take(op, record_);
    return true;
  }

  // Parses `content` with `parse`; a record that ends too early is damage.
  template <typename Parse>
  static auto Parsed(std::string_view content, Parse parse) {
    try {
      Cursor cursor(content);
      return parse(cursor);
    } catch (const std::runtime_error& error) {
      throw DamageError(error.what());
    }
  }

  void Take(Op op, std::string_view content) {
    switch (op) {
      case Op::kSchema: TakeSchema(content); return;
      case Op::kChannel: TakeChannel(content); return;
      case Op::kMessage: TakeMessage(content); return;
      case Op::kChunk: TakeChunk(content); return;
      case Op::kAttachment: TakeAttachment(content); return;
      case Op::kMetadata: TakeMetadata(content); return;
      case Op::kStatistics:
        num_promised_ = Parsed(content, [](Cursor& c) { return c.Number<std::uint64_t>(); });
        return;
      case Op::kFooter: ended_ = true; return;
      default: return;  // indexes, and records of later versions
    }
  }

  void TakeSchema(std::string_view content) {
    const auto [id, name] = Parsed(content, [](Cursor& c) {
      const auto number = c.Number<std::uint16_t>();
      return std::pair{number, std::string(c.Text())};
    });
    schemas_[id] = name;
  }

  void TakeChannel(std::string_view content) {
    Parsed(content, [this](Cursor& c) {
      const auto id = c.Number<std::uint16_t>();
      const auto schema = c.Number<std::uint16_t>();
      channels_[id] = {std::string(c.Text()), schema};
      return 0;
    });
  }

  void TakeMessage(std::string_view content) {
    const McapMessage message = Parsed(content, [this](Cursor& c) {
      const auto channel = channels_.find(c.Number<std::uint16_t>());
      if (channel == channels_.end()) {
        throw DamageError("a message of an unknown channel");
      }
      McapMessage m;
      m.topic = channel->second.topic;
      m.schema = schemas_[channel->second.schema];
      c.Number<std::uint32_t>();  // sequence
      m.time_ns = static_cast<std::int64_t>(c.Number<std::uint64_t>());
      c.Number<std::uint64_t>();  // publish time
      m.data = c.Rest();
      return m;
    });
    ++num_messages_;
    if (visitor_.on_message) {
      visitor_.on_message(message);
    }
  }

  void TakeChunk(std::string_view content) {
    std::uint64_t size = 0;
    std::uint32_t crc = 0;
    std::string_view compression;
    const std::string_view records = Parsed(content, [&](Cursor& c) {
      c.Number<std::uint64_t>();
      c.Number<std::uint64_t>();
      size = c.Number<std::uint64_t>();
      crc = c.Number<std::uint32_t>();
      compression = c.Text();
      return c.Bytes(c.Number<std::uint64_t>());
    });
    std::string_view plain = records;
    if (compression == "zstd") {
      if (size > kMostBytes || size / kMostPacked > records.size()) {
        throw DamageError("a chunk of impossible size");
      }
      chunk_.resize(size);
      if (ZSTD_decompress(chunk_.data(), size, records.data(), records.size()) != size) {
        throw DamageError("a chunk cannot be unpacked");
      }
      plain = chunk_;
    } else if (!compression.empty()) {
      throw DamageError(fmt::format("chunks are packed by \"{}\"; only zstd is read", compression));
    }
    if (crc != 0 && crc32_z(0, reinterpret_cast<const Bytef*>(plain.data()), plain.size()) != crc) {
      throw DamageError("a chunk's checksum is wrong");
    }
    for (Cursor cursor(plain); !cursor.empty();) {
      const auto [op, record] = Parsed(plain, [&](Cursor&) {
        const auto code = static_cast<Op>(cursor.Number<std::uint8_t>());
        return std::pair{code, cursor.Bytes(cursor.Number<std::uint64_t>())};
      });
      if (op == Op::kChunk) {
        throw DamageError("a chunk within a chunk");
      }
      Take(op, record);
    }
  }

  void TakeAttachment(std::string_view content) {
    const McapAttachment attachment = Parsed(content, [](Cursor& c) {
      McapAttachment a;
      c.Number<std::uint64_t>();
      c.Number<std::uint64_t>();
      a.name = c.Text();
      a.media_type = c.Text();
      a.data = c.Bytes(c.Number<std::uint64_t>());
      return a;
    });
    if (visitor_.on_attachment) {
      visitor_.on_attachment(attachment);
    }
  }

  void TakeMetadata(std::string_view content) {
    const auto [name, entries] = Parsed(content, [](Cursor& c) {
      const std::string_view title = c.Text();
      return std::pair{title, c.Map()};
    });
    if (name == kFormatRecord) {
      if (const std::string why = WhyUnreadable(entries); !why.empty()) {
        throw std::runtime_error(path_.string() + ": " + why);
      }
    }
    if (visitor_.on_metadata) {
      visitor_.on_metadata(name, entries);
    }
  }

  struct Channel {
    std::string topic;
    std::uint16_t schema = 0;
  };

  const std::filesystem::path path_;
  const McapVisitor& visitor_;
  std::ifstream file_;
  std::uint64_t size_ = 0;
  bool ended_ = false;
  std::uint64_t num_messages_ = 0;
  std::uint64_t num_promised_ = 0;  // from the summary at the file's end
  std::string record_;
  std::string chunk_;
  std::map<std::uint16_t, std::string> schemas_;
  std::map<std::uint16_t, Channel> channels_;
};

}  // namespace

McapEnd ReadMcap(const std::filesystem::path& path, const McapVisitor& visitor) {
  return Reader(path, visitor).Read();
}

}  // namespace fovea::log
