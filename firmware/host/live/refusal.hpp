// SPDX-License-Identifier: Apache-2.0
// Why a viewer's message is refused: one line for the person at the viewer.
#pragma once

#include <algorithm>
#include <stdexcept>
#include <string>

namespace fovea::live {

// Text from a client as the server repeats it: at most 64 bytes, without control characters and without the
// bytes of a letter that was cut or is no ASCII letter.
inline std::string Quoted(std::string text) {
  constexpr std::size_t kMost = 64;
  if (text.size() > kMost) {
    text.resize(kMost);
  }
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c < 0x20 || c >= 0x7F; }, '?');
  return text;
}

class Refusal : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace fovea::live
