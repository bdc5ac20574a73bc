// Bad input: one line for the person who can mend it. Thrown outside the tick only.
#pragma once

#include <stdexcept>

namespace fovea::config {

// what() says what is wrong, where (file, line, key), and what is allowed.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace fovea::config
