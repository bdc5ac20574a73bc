// SPDX-License-Identifier: Apache-2.0
#include "sim/operator/fault_panel.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "firmware/host/config/input_error.hpp"

namespace fovea::sim {
namespace {

using config::InputError;

constexpr double kLasts = 1e6;  // end of a fault that nobody has stopped [s]
// A fault that ended less than this ago may still act in the present step [s]. A window that begins anew and
// is stopped before that step would forget it: a load would hang for ever.
constexpr double kJustEnded = 1.5e-3;

// A size with the function that changes it.
struct BoundSize {
  FaultSize size;
  std::function<void(double)> set;
};

struct BoundSwitch {
  FaultField field;
  TimeWindow* window;
  bool is_served;
  std::vector<BoundSize> sizes;
};

// Collects the switches from the lists of fields. The sizes of a fault follow its window.
class SwitchCollector {
 public:
  explicit SwitchCollector(int num_joints) : num_joints_(num_joints) {}

  void Window(const FaultField& field, TimeWindow& window, const char* not_served = nullptr) {
    all.push_back({field, &window, not_served == nullptr, {}});
  }
  void Number(const FaultField& field, double& value, double min, double max) {
    Add(field, field.key, min, max, false, value, [&value](double number) { value = number; });
  }
  template <class T>
  void Scaled(const FaultField& field, T& value, double unit, double min, double max) {
    Add(field, field.key, min, max, false, static_cast<double>(value) / unit,
        [&value, unit](double number) { value = static_cast<T>(unit * number); });
  }
  void Flag(const FaultField& field, bool& value) {
    Add(field, field.key, 0.0, 1.0, true, value ? 1.0 : 0.0,
        [&value](double number) { value = number != 0.0; });
  }
  void Joint(const FaultField& field, int& value, const TimeWindow& /*window*/, int least) {
    static_assert(kAllJoints == -1);
    Add(field, field.key, least, num_joints_, true, value + 1,
        [&value](double number) { value = static_cast<int>(number) - 1; });
  }
  void List(const FaultField& field, Eigen::VectorXd& values, std::size_t /*most*/, double min, double max) {
    for (int i = 0; i < num_joints_; ++i) {
      const auto set = [&values, i, size = num_joints_](double number) {
        if (values.size() == 0) {
          values = Eigen::VectorXd::Zero(size);
        }
        values[i] = number;
      };
      AddEntry(field, i, min, max, i < values.size() ? values[i] : 0.0, set);
    }
  }
  template <std::size_t kSize>
  void List(const FaultField& field, std::array<double, kSize>& values, std::size_t most, double min,
            double max) {
    for (std::size_t i = 0; i < most; ++i) {
      AddEntry(field, static_cast<int>(i), min, max, values[i],
               [&values, i](double number) { values[i] = number; });
    }
  }
  template <class... Doubles>
  void Numbers(const FaultField& field, double min, double max, Doubles&... values) {
    int i = 0;
    (AddEntry(field, i++, min, max, values, [&values](double number) { values = number; }), ...);
  }
  void Size(const FaultField& /*field*/, double /*value*/) {}

  std::vector<BoundSwitch> all;

 private:
  void Add(const FaultField& field, std::string name, double min, double max, bool whole, double value,
           std::function<void(double)> set) {
    all.back().sizes.push_back(
        {{std::move(name), field.unit, field.meaning, min, max, whole, value}, std::move(set)});
  }
  void AddEntry(const FaultField& field, int index, double min, double max, double value,
                std::function<void(double)> set) {
    Add(field, fmt::format("{}[{}]", field.key, index + 1), min, max, false, value, std::move(set));
  }

  const int num_joints_;
};

// The switches of `faults`, which must outlive them. "nothing" is no fault to switch on.
std::vector<BoundSwitch> SwitchesOf(FaultSettings& faults, int num_joints, FaultChoice choice) {
  SwitchCollector switches(num_joints);
  Fields(switches, faults);
  std::erase_if(switches.all, [&](const BoundSwitch& fault) {
    return fault.window == &faults.nothing || (choice == FaultChoice::kServed && !fault.is_served);
  });
  return std::move(switches.all);
}

BoundSwitch& Find(std::vector<BoundSwitch>& all, const std::string& name) {
  const auto found =
      std::find_if(all.begin(), all.end(), [&](const BoundSwitch& fault) { return fault.field.key == name; });
  if (found == all.end()) {
    throw InputError(fmt::format("there is no fault \"{}\"", name));
  }
  return *found;
}

void SetSize(BoundSwitch& fault, const std::string& name, double value) {
  const auto found = std::find_if(fault.sizes.begin(), fault.sizes.end(),
                                  [&](const BoundSize& bound) { return bound.size.name == name; });
  if (found == fault.sizes.end()) {
    throw InputError(fmt::format("the fault \"{}\" has no \"{}\"", fault.field.key, name));
  }
  const FaultSize& size = found->size;
  const bool wrong_kind = size.whole && std::nearbyint(value) != value;
  if (!std::isfinite(value) || wrong_kind || value < size.min || value > size.max) {
    throw InputError(fmt::format("faults.{} = {:g} is not allowed: expected {}, {:g} to {:g}{}{}", name,
                                 value, size.whole ? "a whole number" : "a number", size.min, size.max,
                                 size.unit.empty() ? "" : " ", size.unit));
  }
  found->set(value);
}

}  // namespace

std::vector<FaultSwitch> FaultPanel::Switches(double now_s) const {
  FaultSettings faults = faults_;
  std::vector<FaultSwitch> switches;
  for (const BoundSwitch& fault : SwitchesOf(faults, num_joints_, choice_)) {
    FaultSwitch shown{fault.field.key, fault.field.meaning, false, {}};
    shown.active = now_s >= fault.window->start_s && now_s < fault.window->end_s;
    for (const BoundSize& bound : fault.sizes) {
      shown.sizes.push_back(bound.size);
    }
    switches.push_back(std::move(shown));
  }
  return switches;
}

void FaultPanel::Start(const std::string& name, const std::map<std::string, double>& sizes, double now_s) {
  FaultSettings changed = faults_;
  std::vector<BoundSwitch> all = SwitchesOf(changed, num_joints_, choice_);
  BoundSwitch& fault = Find(all, name);
  for (const auto& [size, value] : sizes) {
    SetSize(fault, size, value);
  }
  const bool goes_on =
      fault.window->Begins() && now_s >= fault.window->start_s && now_s < fault.window->end_s + kJustEnded;
  *fault.window = {goes_on ? fault.window->start_s : now_s, kLasts};
  CheckFaults(changed, num_joints_);
  if (fault.window == &changed.bench.push.window && changed.bench.push.tau.isZero(0.0)) {
    throw InputError("faults.push is 0 for each joint: give at least one of them a torque");
  }
  faults_ = changed;
}

void FaultPanel::Stop(const std::string& name, double now_s) {
  std::vector<BoundSwitch> all = SwitchesOf(faults_, num_joints_, choice_);
  TimeWindow& window = *Find(all, name).window;
  window.end_s = std::min(window.end_s, std::max(now_s, window.start_s));
}

}  // namespace fovea::sim
