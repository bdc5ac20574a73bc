// SPDX-License-Identifier: Apache-2.0
// Bad input: one line for the person who can correct it. Thrown only outside the tick.
#pragma once

#include <algorithm>
#include <stdexcept>
#include <string>

namespace fovea::config {

// what() says what is wrong, where (file, line, key), and what is allowed. It quotes the input, with each
// control character (a line end, a terminal code) shown as a question mark.
class InputError : public std::runtime_error {
 public:
  explicit InputError(std::string what) : std::runtime_error(Shown(what)) {}

 private:
  static const std::string& Shown(std::string& what) {
    std::replace_if(
        what.begin(), what.end(), [](unsigned char c) { return c < 0x20 || c == 0x7F; }, '?');
    return what;
  }
};

}  // namespace fovea::config
