// SPDX-License-Identifier: Apache-2.0
#include "sim/scenario/serve_keys.hpp"

#include <poll.h>
#include <unistd.h>

#include <array>
#include <sstream>

namespace fovea::sim {

ServeKey ParseServeKey(const std::string& line) {
  using Kind = ServeKey::Kind;
  std::istringstream words(line);
  std::string key;
  std::string more;
  ServeKey out;
  words >> key;
  if (key == "f") {
    Eigen::Vector3d& f = out.force_B;
    out.kind = words >> f[0] >> f[1] >> f[2] && f.allFinite() ? Kind::kPull : Kind::kUnknown;
  } else {
    out.kind = key == "s"   ? Kind::kStop
               : key == "g" ? Kind::kGuide
               : key == "h" ? Kind::kHang
                            : Kind::kUnknown;
  }
  return words >> more ? ServeKey{} : out;
}

std::optional<ServeKey> ServeKeys::Next() {
  std::size_t end = buffer_.find('\n');
  while (end == std::string::npos && FillBuffer()) {
    end = buffer_.find('\n');
  }
  if (end == std::string::npos) {
    return std::nullopt;
  }
  const ServeKey key = ParseServeKey(buffer_.substr(0, end));
  buffer_.erase(0, end + 1);
  return key;
}

bool ServeKeys::FillBuffer() {
  constexpr std::size_t kMostUnread = 4096;  // longest line
  pollfd wait{STDIN_FILENO, POLLIN, 0};
  if (closed_ || poll(&wait, 1, 0) != 1) {
    return false;
  }
  std::array<char, 256> some{};
  const auto got = read(STDIN_FILENO, some.data(), some.size());
  closed_ = got <= 0 || buffer_.size() > kMostUnread;
  if (!closed_) {
    buffer_.append(some.data(), static_cast<std::size_t>(got));
  }
  return !closed_;
}

}  // namespace fovea::sim
