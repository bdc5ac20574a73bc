// SPDX-License-Identifier: Apache-2.0
// Whoever else wants the messages of a log, as it writes them: encoded once, for the file and for viewers.
#pragma once

#include <cstdint>
#include <functional>
#include <string_view>

namespace google::protobuf {
class Descriptor;
}

namespace fovea::log {

// `bytes`: the serialised message, valid during the call. Must not throw, and must not wait: the log waits.
using LogTap = std::function<void(std::string_view topic, const google::protobuf::Descriptor& type,
                                  std::int64_t time_ns, std::string_view bytes)>;

}  // namespace fovea::log
