// SPDX-License-Identifier: Apache-2.0
// A log from an untrusted source, as the report reads it: arbitrary bytes as a file, as its records, or as
// the messages in it. It is refused with a one-line error, or it becomes a run that the page can show.
#include <nlohmann/json.hpp>
#include <vector>

#include "firmware/host/recording/log/topics.hpp"
#include "firmware/host/report/report.hpp"
#include "tests/fuzz/bytes.hpp"
#include "tests/fuzz/fuzz.hpp"
#include "tests/fuzz/input_file.hpp"

using fovea::fuzz::Require;
using namespace fovea;

namespace {

constexpr const char* kTopics[] = {log::kSetupTopic,      log::kTickTopic,        log::kTruthTopic,
                                   log::kTheoryTopic,     log::kFeatureTopic,     log::kImageTopic,
                                   log::kAnnotationTopic, log::kCalibrationTopic, log::kTickTimesTopic,
                                   log::kSceneTopic,      log::kTransformTopic};
constexpr std::size_t kNumTopics = std::size(kTopics);

class Writer {
 public:
  Writer() : bytes_{0x89, 'M', 'C', 'A', 'P', '0', '\r', '\n'} {}

  template <typename Number>
  static void Put(std::vector<std::uint8_t>& to, Number value) {
    for (std::size_t i = 0; i < sizeof(Number); ++i) {
      to.push_back(static_cast<std::uint8_t>(static_cast<std::uint64_t>(value) >> (8 * i)));
    }
  }
  static void PutText(std::vector<std::uint8_t>& to, std::string_view text) {
    Put(to, static_cast<std::uint32_t>(text.size()));
    to.insert(to.end(), text.begin(), text.end());
  }
  void Record(std::uint8_t op, std::span<const std::uint8_t> content) {
    bytes_.push_back(op);
    Put(bytes_, static_cast<std::uint64_t>(content.size()));
    bytes_.insert(bytes_.end(), content.begin(), content.end());
  }
  void Channels() {
    for (std::size_t i = 0; i < kNumTopics; ++i) {
      std::vector<std::uint8_t> channel;
      Put(channel, static_cast<std::uint16_t>(i));
      Put(channel, std::uint16_t{0});
      PutText(channel, kTopics[i]);
      Record(4, channel);
    }
  }
  void Message(std::size_t topic, std::uint64_t time_ns, std::span<const std::uint8_t> data) {
    std::vector<std::uint8_t> message;
    Put(message, static_cast<std::uint16_t>(topic));
    Put(message, std::uint32_t{0});
    Put(message, time_ns);
    Put(message, time_ns);
    message.insert(message.end(), data.begin(), data.end());
    Record(5, message);
  }
  [[nodiscard]] std::span<const std::uint8_t> bytes() const { return bytes_; }

 private:
  std::vector<std::uint8_t> bytes_;
};

// Records of any kind, or messages of known topics.
Writer Compose(fuzz::Bytes& input, bool messages) {
  Writer writer;
  writer.Channels();
  while (!input.empty()) {
    const std::uint8_t kind = input.Byte();
    const std::size_t size = 256U * input.Byte() + input.Byte();
    if (!messages) {
      writer.Record(kind, input.Take(size));
      continue;
    }
    const std::uint64_t time_ns = std::uint64_t{input.Word()} << (kind >> 4U) * 2U;
    writer.Message(kind % kNumTopics, time_ns, input.Take(size));
  }
  return writer;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const fuzz::InputFile file("log.mcap");
  fuzz::Bytes input(data, size);
  const std::uint8_t how = input.Byte() % 3;
  const std::filesystem::path path =
      how == 0 ? file.Write(input.Rest()) : file.Write(Compose(input, how == 1).bytes());
  try {
    const std::string json = report::ToJson(report::ReadRun(path));
    Require(nlohmann::json::accept(json), "the report's data is valid JSON");
  } catch (const std::runtime_error& error) {
    Require(fuzz::IsOneLine(error.what()), "an error message is one line");
  }
  return 0;
}
