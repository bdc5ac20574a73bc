// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "firmware/host/config/input_error.hpp"

namespace fovea::test {

// The message of the InputError that `act` throws; "" if it throws none.
template <class Act>
std::string InputErrorOf(Act&& act) {
  try {
    act();
  } catch (const config::InputError& error) {
    return error.what();
  }
  return "";
}

}  // namespace fovea::test
