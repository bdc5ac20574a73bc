// SPDX-License-Identifier: Apache-2.0
#include "sim/scenario/fault_settings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string>

#include "firmware/host/config/input_error.hpp"
#include "sim/faults/fault_reader.hpp"

namespace fovea::sim {
namespace {

using config::InputError;
using Field = FaultField;

std::string KeyOf(const Field& field) { return std::string("faults.") + field.key; }
std::string WindowKeyOf(const Field& field) { return KeyOf(field) + "_s"; }

// Adds the keys. If a field has another unit than its key, the key's default is converted from the field.
class FaultKeys {
 public:
  explicit FaultKeys(config::KeyTable& keys) : keys_(keys) {}

  void Window(const Field& field, TimeWindow& window, const char* /*not_served*/ = nullptr) {
    keys_.Numbers(WindowKeyOf(field), {window.start_s, window.end_s}, 2, 2, 0.0, 1e6, field.unit,
                  std::string("from the first time to the second: ") + field.meaning,
                  [&window](const std::vector<double>& s) {
                    window = {s[0], s[1]};
                  });
  }
  void Number(const Field& field, double& value, double min, double max) {
    keys_.Number(KeyOf(field), value, min, max, field.unit, field.meaning);
  }
  template <class T>
  void Scaled(const Field& field, T& value, double unit, double min, double max) {
    keys_.Number(KeyOf(field), static_cast<double>(value) / unit, min, max, field.unit, field.meaning,
                 [&value, unit](double number) { value = static_cast<T>(unit * number); });
  }
  void Flag(const Field& field, bool& value) { keys_.Flag(KeyOf(field), value, field.meaning); }
  void Joint(const Field& field, int& value, const TimeWindow& /*window*/, int least) {
    static_assert(kAllJoints == -1);
    keys_.Integer(KeyOf(field), value + 1, least, hal::kMaxJoints, field.unit, field.meaning,
                  [&value](int joint) { value = joint - 1; });
  }
  template <class Values>
  void List(const Field& field, Values& values, std::size_t most, double min, double max) {
    std::vector<double> defaults(values.begin(), values.end());
    while (!defaults.empty() && defaults.back() == 0.0) {
      defaults.pop_back();
    }
    keys_.Numbers(KeyOf(field), defaults, 1, most, min, max, field.unit, field.meaning,
                  [&values](const std::vector<double>& numbers) { Take(numbers, values); });
  }
  template <class... Doubles>
  void Numbers(const Field& field, double min, double max, Doubles&... values) {
    const std::array<double*, sizeof...(values)> all{&values...};
    keys_.Numbers(KeyOf(field), {values...}, all.size(), all.size(), min, max, field.unit, field.meaning,
                  [all](const std::vector<double>& numbers) {
                    for (std::size_t i = 0; i < all.size(); ++i) {
                      *all[i] = numbers[i];
                    }
                  });
  }
  void Size(const Field& /*field*/, double /*value*/) {}

 private:
  // Missing entries are 0.
  template <std::size_t kSize>
  static void Take(const std::vector<double>& numbers, std::array<double, kSize>& values) {
    values.fill(0.0);
    std::copy(numbers.begin(), numbers.end(), values.begin());
  }
  static void Take(const std::vector<double>& numbers, Eigen::VectorXd& values) {
    values = Eigen::Map<const Eigen::VectorXd>(numbers.data(), static_cast<Eigen::Index>(numbers.size()));
  }

  config::KeyTable& keys_;
};

class FaultsMet : public FaultReader {
 public:
  void Window(const Field& field, const TimeWindow& window, const char* /*not_served*/ = nullptr) {
    if (window.Begins()) {
      met.push_back({field.key, window.start_s, window.end_s});
    }
  }
  std::vector<FaultWindow> met;
};

class FaultChecks : public FaultReader {
 public:
  explicit FaultChecks(int num_joints) : num_joints_(num_joints) {}

  void Window(const Field& field, const TimeWindow& window, const char* /*not_served*/ = nullptr) const {
    if (window.start_s > window.end_s) {
      throw InputError(fmt::format("{} = [{}, {}] is not allowed: it ends before it begins",
                                   WindowKeyOf(field), window.start_s, window.end_s));
    }
  }
  void Joint(const Field& field, const int& value, const TimeWindow& window, int /*least*/) const {
    if (window.Begins() && value >= num_joints_) {
      throw InputError(
          fmt::format("{} = {} is not allowed: the arm has {} joints", KeyOf(field), value + 1, num_joints_));
    }
  }
  void Size(const Field& field, double value) const {
    if (value <= 0.0) {
      throw InputError(fmt::format("{} is not allowed: its size must be above 0 px", KeyOf(field)));
    }
  }

 private:
  const int num_joints_;
};

class ServedChecks : public FaultReader {
 public:
  void Window(const Field& field, const TimeWindow& window, const char* not_served = nullptr) const {
    if (not_served != nullptr && window.Begins()) {
      throw InputError(fmt::format("{} = [{}, {}] is not allowed with serve: {}", WindowKeyOf(field),
                                   window.start_s, window.end_s, not_served));
    }
  }
};

}  // namespace

std::vector<FaultWindow> FaultsOf(const FaultSettings& faults) {
  FaultsMet reader;
  Fields(reader, faults);
  return reader.met;
}

void AddFaultKeys(FaultSettings& faults, config::KeyTable& keys) {
  FaultKeys adder(keys);
  Fields(adder, faults);
}

void CheckFaults(const FaultSettings& faults, int num_joints) {
  FaultChecks checks(num_joints);
  Fields(checks, faults);
}

void CheckServedFaults(const FaultSettings& faults) {
  ServedChecks checks;
  Fields(checks, faults);
}

}  // namespace fovea::sim
