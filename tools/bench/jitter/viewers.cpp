// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/jitter/viewers.hpp"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <stdexcept>
#include <string_view>

#include "firmware/host/recording/log/tick_message.hpp"
#include "firmware/host/recording/log/topics.hpp"
#include "fovea/hal/record.hpp"
#include "fovea/tick.pb.h"
#include "foxglove/image.pb.h"

namespace fovea::bench {
namespace {

constexpr int kTicksPerPicture = 33;
constexpr const char* kToken = "jitter-of-the-bench";
constexpr std::chrono::seconds kPatience{5};
constexpr int kPongMs = 4000;  // a viewer that says nothing for long is disconnected

std::string TickBytes() {
  hal::TickRecord record;
  record.arm.num_joints = 7;
  log::Tick tick;
  log::ToMessage(record, tick);
  return tick.SerializeAsString();
}

std::string PictureBytes() {
  cv::Mat picture(480, 640, CV_8UC3);
  cv::randu(picture, cv::Scalar::all(90), cv::Scalar::all(110));
  std::vector<unsigned char> jpeg;
  cv::imencode(".jpg", picture, jpeg, {cv::IMWRITE_JPEG_QUALITY, 80});
  foxglove::CompressedImage image;
  image.set_format("jpeg");
  image.set_data(jpeg.data(), jpeg.size());
  return image.SerializeAsString();
}

// A frame of the WebSocket protocol (RFC 6455) from a client, with the mask 0.
std::string ClientFrame(unsigned char op, std::string_view payload) {
  constexpr unsigned char kFinal = 0x80;
  constexpr unsigned char kMasked = 0x80;
  constexpr std::size_t kShort = 126;  // longer payloads have a length of 16 bits
  std::string frame{static_cast<char>(kFinal | op)};
  if (payload.size() < kShort) {
    frame += static_cast<char>(kMasked | payload.size());
  } else {
    frame += static_cast<char>(kMasked | kShort);
    frame += static_cast<char>(payload.size() >> 8U);
    frame += static_cast<char>(payload.size() & 0xFFU);
  }
  frame.append(4, '\0');
  return frame.append(payload);
}

// A connection to a port of this computer, closed when destroyed.
class Connection {
 public:
  explicit Connection(std::uint16_t port) : fd_(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if (connect(fd_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
      throw std::runtime_error("the live page refuses the connection");
    }
  }
  ~Connection() { close(fd_); }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  void Send(std::string_view bytes) const {
    if (send(fd_, bytes.data(), bytes.size(), MSG_NOSIGNAL) != static_cast<ssize_t>(bytes.size())) {
      throw std::runtime_error("the live page has closed the connection");
    }
  }
  // What has come within `most_ms`; "" if nothing.
  std::string_view Receive(int most_ms) {
    pollfd readable{fd_, POLLIN, 0};
    if (poll(&readable, 1, most_ms) == 0) {
      return {};
    }
    const ssize_t count = recv(fd_, buffer_.data(), buffer_.size(), 0);
    if (count <= 0) {
      throw std::runtime_error("the live page has closed the connection");
    }
    return {buffer_.data(), static_cast<std::size_t>(count)};
  }

 private:
  int fd_;
  std::array<char, 65536> buffer_{};
};

}  // namespace

Viewers::Viewers() : channels_(live::LogChannels({})) {
  live::Catalogue catalogue;
  catalogue.name = "jitter";
  catalogue.channels = channels_;
  live::ServerConfig config;
  config.port = 0;
  config.token = kToken;
  server_ = std::make_unique<live::Server>(config, catalogue);
  feed_ = std::make_unique<live::LiveFeed>(*server_, channels_);
  for (int i = 0; i < kViewers; ++i) {
    viewers_.emplace_back([this](const std::stop_token& stop) { View(stop); });
  }
  const auto until = std::chrono::steady_clock::now() + kPatience;
  while (connected_ < kViewers && !failed_ && std::chrono::steady_clock::now() < until) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  if (connected_ < kViewers) {
    throw std::runtime_error("the viewers cannot connect to the live page");
  }
  feeder_ = std::jthread([this](const std::stop_token& stop) { Feed(stop); });
}

Viewers::~Viewers() {
  for (std::jthread& viewer : viewers_) {
    viewer.request_stop();
  }
  feeder_ = {};
  feed_.reset();
  server_.reset();  // closes the connections, which ends the viewers' reads
}

void Viewers::Feed(const std::stop_token& stop) {
  const std::string tick = TickBytes();
  const std::string picture = PictureBytes();
  auto next = std::chrono::steady_clock::now();
  std::int64_t stamp_ns = 0;
  for (std::int64_t k = 0; !stop.stop_requested(); ++k) {
    feed_->Take(log::kTickTopic, *log::Tick::descriptor(), stamp_ns, tick);
    if (k % kTicksPerPicture == 0) {
      feed_->Take(log::kImageTopic, *foxglove::CompressedImage::descriptor(), stamp_ns, picture);
    }
    stamp_ns += hal::kTickPeriodNs;
    next += std::chrono::nanoseconds(hal::kTickPeriodNs);
    std::this_thread::sleep_until(next);
  }
}

// Subscribes to all channels, and reads until the server closes the connection.
void Viewers::View(const std::stop_token& stop) {
  constexpr unsigned char kText = 0x1;
  constexpr unsigned char kPong = 0xA;
  try {
    Connection connection(server_->port());
    connection.Send(fmt::format(
        "GET /?token={} HTTP/1.1\r\nHost: 127.0.0.1:{}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
        "Sec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\nSec-WebSocket-Version: 13\r\n"
        "Sec-WebSocket-Protocol: foxglove.sdk.v1\r\n\r\n",
        kToken, server_->port()));
    if (!connection.Receive(kPongMs).starts_with("HTTP/1.1 101")) {
      throw std::runtime_error("the live page is no WebSocket server");
    }
    std::string subscriptions;
    for (std::size_t i = 0; i < channels_.size(); ++i) {
      subscriptions += fmt::format("{}{{\"id\":{},\"channelId\":{}}}", i == 0 ? "" : ",", i, i + 1);
    }
    connection.Send(
        ClientFrame(kText, fmt::format("{{\"op\":\"subscribe\",\"subscriptions\":[{}]}}", subscriptions)));
    ++connected_;
    auto next_pong = std::chrono::steady_clock::now();
    while (!stop.stop_requested()) {
      static_cast<void>(connection.Receive(kPongMs));
      if (std::chrono::steady_clock::now() >= next_pong) {
        connection.Send(ClientFrame(kPong, ""));
        next_pong = std::chrono::steady_clock::now() + std::chrono::milliseconds(kPongMs);
      }
    }
  } catch (const std::exception&) {
    failed_ = !stop.stop_requested();
  }
}

}  // namespace fovea::bench
