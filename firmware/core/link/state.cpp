// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/link/state.hpp"

#include <algorithm>
#include <bit>

#include "firmware/core/link/state_fields.hpp"
#include "firmware/core/trajectory/plan_request.hpp"

namespace fovea::link {
namespace {

// Mixes fields into 64 bits, in two lanes that do not wait for each other. Each step is bijective, so that no
// single difference is lost.
class Mixer {
 public:
  void operator()(bool value) noexcept { Put(value ? 1U : 0U); }
  void operator()(std::uint32_t value) noexcept { Put(value); }
  void operator()(std::uint64_t value) noexcept { Put(value); }
  void operator()(std::int64_t value) noexcept { Put(static_cast<std::uint64_t>(value)); }
  void operator()(double value) noexcept { Put(std::bit_cast<std::uint64_t>(value)); }
  // Same result as one after the other: each lane takes every second value.
  void Row(const double* values, std::size_t count) noexcept {
    std::uint64_t lane = lane_;
    std::uint64_t next = next_;
    const double* const end_of_pairs = values + (count & ~std::size_t{1});
    for (; values != end_of_pairs; values += 2) {
      lane = Mixed(lane, std::bit_cast<std::uint64_t>(values[0]));
      next = Mixed(next, std::bit_cast<std::uint64_t>(values[1]));
    }
    lane_ = lane;
    next_ = next;
    if (count % 2 != 0) {
      (*this)(*values);
    }
  }
  template <class Integer>
  void Int(Integer value) noexcept {
    Put(static_cast<std::uint32_t>(value));
  }
  template <class Integer>
  void Count(Integer value, int /*most*/) noexcept {
    Put(static_cast<std::uint32_t>(value));
  }
  template <class Enum>
  void Choice(Enum value, int /*count*/) noexcept {
    Put(static_cast<std::uint64_t>(value));
  }

  [[nodiscard]] std::uint64_t Finish() noexcept {
    Put(next_);
    Put(next_);
    return lane_ ^ std::rotl(next_, 32);
  }

 private:
  static std::uint64_t Mixed(std::uint64_t lane, std::uint64_t value) noexcept {
    return std::rotl((lane ^ value) * 0x9E3779B97F4A7C15U, 29);
  }
  void Put(std::uint64_t value) noexcept {
    const std::uint64_t mixed = Mixed(lane_, value);
    lane_ = next_;
    next_ = mixed;
  }

  std::uint64_t lane_ = 0x243F6A8885A308D3U;  // digits of pi
  std::uint64_t next_ = 0x13198A2E03707344U;
};

// True unless the arm is on a plan that is not whole.
bool HasItsPlan(const task::ServoState& state) noexcept {
  const trajectory::Plan& plan = state.plans.plan();
  return state.way.note.way != hal::Way::kPlan ||
         (plan.IsFound() && plan.IsSound() && state.plans.received() == plan.NumNumbers() &&
          plan.num_joints == state.way.q_end.size() && plan.num_joints == state.way.shift.size());
}

template <class Archive, class T>
void FieldsOfDemand(Archive& a, T& demand) noexcept {
  a.Choice(demand.arm_status, kNumStatusCodes);
  DemandFields(a, demand);
}

}  // namespace

Bytes Encode(const Demand& message, Storage storage) noexcept {
  FieldWriter writer(storage);
  FieldsOfDemand(writer, message);
  if (message.tuning.IsAsked() || message.plan.IsThere()) {
    TuningFields(writer, message.tuning);
  }
  if (message.plan.IsThere()) {
    PlanPartFields(writer, message.plan);
  }
  return writer.ok() ? writer.written() : Bytes{};
}

bool Decode(Bytes bytes, Demand& message) noexcept {
  FieldReader reader(bytes);
  FieldsOfDemand(reader, message);
  message.tuning = {};
  message.plan = {};
  if (!reader.Done()) {
    TuningFields(reader, message.tuning);
  }
  if (!reader.Done()) {
    PlanPartFields(reader, message.plan);
  }
  return reader.Done();
}

Bytes Encode(const task::ServoState& state, Storage storage) noexcept {
  FieldWriter writer(storage);
  EachGroup(state, [&writer](Pace, const char*, const auto& fields) { fields(writer); });
  return writer.ok() ? writer.written() : Bytes{};
}

bool Decode(Bytes bytes, task::ServoState& state) noexcept {
  FieldReader reader(bytes);
  EachGroup(state, [&reader](Pace, const char*, const auto& fields) { fields(reader); });
  const estimate::PoseHypotheses& poses = state.predict.hypotheses;
  const bool compares = !poses.comparison.runs || poses.comparison.pose < poses.plate.count;
  return reader.Done() && HasItsPlan(state) && compares;
}

std::uint64_t DigestOf(const config::ServoConfig& config, const task::ServoState& state,
                       bool measured) noexcept {
  const hal::Mode mode = state.mode.mode;
  const bool tracks = mode == hal::Mode::kTrack || mode == hal::Mode::kCoast;
  const bool seeks = tracks && trajectory::HasGoalPosture(config);
  const auto counts = [&](Pace pace) {
    switch (pace) {
      case Pace::kTick: return true;
      case Pace::kMeasurement:
        return measured || state.predict.hypotheses.comparison.runs ||
               state.predict.hypotheses.comparison.ended;
      case Pace::kSeeking: return seeks;
      case Pace::kMoving: return mode == hal::Mode::kMove;
      case Pace::kTuning: return state.tuning.active;
      case Pace::kFollows: return false;
    }
    return false;
  };
  Mixer mixer;
  EachGroup(state, [&](Pace pace, const char*, const auto& fields) {
    if (counts(pace)) {
      fields(mixer);
    }
  });
  return mixer.Finish();
}

const char* FirstDifference(const task::ServoState& a, const task::ServoState& b, Storage storage_a,
                            Storage storage_b) noexcept {
  // Group by group: writing `b` shows where its groups end.
  FieldWriter writer_a(storage_a);
  FieldWriter writer_b(storage_b);
  std::array<const char*, 32> names{};
  std::array<std::size_t, 32> ends_a{};
  std::size_t count = 0;
  EachGroup(a, [&](Pace, const char* name, const auto& fields) {
    fields(writer_a);
    names[count] = name;
    ends_a[count++] = writer_a.written().size();
  });
  const char* first = nullptr;
  std::size_t begin_b = 0;
  std::size_t group = 0;
  EachGroup(b, [&](Pace, const char*, const auto& fields) {
    fields(writer_b);
    const std::size_t begin_a = group == 0 ? 0 : ends_a[group - 1];
    const Bytes of_a = writer_a.written().subspan(begin_a, ends_a[group] - begin_a);
    const Bytes of_b = writer_b.written().subspan(begin_b);
    if (first == nullptr && !std::equal(of_a.begin(), of_a.end(), of_b.begin(), of_b.end())) {
      first = names[group];
    }
    begin_b = writer_b.written().size();
    ++group;
  });
  return first;
}

}  // namespace fovea::link
