// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/live/control.hpp"

namespace fovea::live {

bool Control::Take(std::uint64_t viewer, const std::string& name, Clock::time_point now) {
  if (!IsFree() && !Has(viewer)) {
    return false;
  }
  holder_ = viewer;
  name_ = name;
  heard_ = now;
  return true;
}

void Control::Hear(std::uint64_t viewer, Clock::time_point now) {
  if (Has(viewer)) {
    heard_ = now;
  }
}

bool Control::End(std::uint64_t viewer) {
  if (!Has(viewer)) {
    return false;
  }
  holder_ = kNobody;
  name_.clear();
  return true;
}

}  // namespace fovea::live
