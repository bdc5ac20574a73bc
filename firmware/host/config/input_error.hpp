// Bad input: one line for the person who can mend it. Thrown outside the tick only.
#pragma once

#include <algorithm>
#include <stdexcept>
#include <string>

namespace fovea::config {

// what() says what is wrong, where (file, line, key), and what is allowed. It quotes what came in, of which
// line ends and all else that a terminal would obey are shown as question marks.
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
