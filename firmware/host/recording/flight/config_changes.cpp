// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/recording/flight/config_changes.hpp"

#include <bit>
#include <cstdint>
#include <vector>

#include "firmware/core/link/config_fields.hpp"

namespace fovea::flight {
namespace {

// An archive that lists the fields' values, or with `puts` writes listed values into the fields.
class FieldList {
 public:
  std::vector<std::uint64_t> values;
  bool puts = false;

  template <class T>
  void operator()(T& value) {
    if constexpr (std::is_same_v<T, double>) {
      Pass(
          value, [](double v) { return std::bit_cast<std::uint64_t>(v); },
          [](std::uint64_t bits) { return std::bit_cast<double>(bits); });
    } else {
      Plain(value);
    }
  }
  template <class Integer>
  void Int(Integer& value) {
    Plain(value);
  }
  template <class Integer>
  void Count(Integer& value, int /*most*/) {
    Plain(value);
  }
  template <class Enum>
  void Choice(Enum& value, int /*count*/) {
    Plain(value);
  }

 private:
  template <class T>
  void Plain(T& value) {
    Pass(
        value, [](T v) { return static_cast<std::uint64_t>(v); },
        [](std::uint64_t bits) { return static_cast<T>(bits); });
  }
  template <class T, class ToBits, class FromBits>
  void Pass(T& value, const ToBits& to_bits, const FromBits& from_bits) {
    if (puts) {
      value = from_bits(values[at_++]);
    } else {
      values.push_back(to_bits(value));
    }
  }

  std::size_t at_ = 0;
};

std::vector<std::uint64_t> ValuesOf(config::ServoConfig config) {
  FieldList list;
  link::ServoFields(list, config);
  return list.values;
}

}  // namespace

config::ServoConfig WithChanges(const config::ServoConfig& recorded, const config::ServoConfig& before,
                                const config::ServoConfig& after) {
  FieldList merged;
  merged.puts = true;
  merged.values = ValuesOf(recorded);
  const std::vector<std::uint64_t> was = ValuesOf(before);
  const std::vector<std::uint64_t> is = ValuesOf(after);
  for (std::size_t i = 0; i < merged.values.size(); ++i) {
    if (was[i] != is[i]) {
      merged.values[i] = is[i];
    }
  }
  config::ServoConfig config = recorded;
  link::ServoFields(merged, config);
  return config;
}

}  // namespace fovea::flight
