// SPDX-License-Identifier: Apache-2.0
// A visitor of the field lists that finds the first value outside its range.
#pragma once

#include <cmath>
#include <cstddef>

#include "firmware/core/config/fields.hpp"
#include "fovea/hal/status.hpp"
#include "fovea/hal/types.hpp"

namespace fovea::config {

class RangeCheck {
 public:
  // Ok, or the key of the first field that is out of range or not finite.
  [[nodiscard]] const hal::Status& status() const noexcept { return status_; }

  void Flag(const Field& /*field*/, bool /*value*/) noexcept {}
  void Number(const Field& field, double value, double min, double max) noexcept {
    Check(field, value, min, max);
  }
  void Integer(const Field& field, int value, int min, int max) noexcept { Check(field, value, min, max); }
  void Count(const Field& field, int value, int most) noexcept { Check(field, value, 0, most); }
  template <class Enum, class Names>
  void Choice(const Field& field, Enum value, const Names& names) noexcept {
    Check(field, static_cast<int>(value), 0, static_cast<int>(names.size()) - 1);
  }
  void PerJoint(const Field& field, const hal::JointArray& values, double min, double max) noexcept {
    for (const double value : values) {
      Check(field, value, min, max);
    }
  }
  template <class T>
  void Derived(const Field& field, const T& value, double min = 0.0, double max = 1.0) noexcept {
    if constexpr (requires { value.size(); }) {
      for (decltype(value.size()) i = 0; i < value.size(); ++i) {
        Check(field, value.data()[i], min, max);
      }
    } else {
      Check(field, static_cast<double>(value), min, max);
    }
  }

 private:
  void Check(const Field& field, double value, double min, double max) noexcept {
    if (!status_.ok() || (value >= min && value <= max)) {
      return;
    }
    status_ = hal::Status(std::isfinite(value) ? hal::StatusCode::kOutOfRange : hal::StatusCode::kNonFinite,
                          field.key);
  }

  hal::Status status_;
};

}  // namespace fovea::config
