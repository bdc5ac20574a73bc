// SPDX-License-Identifier: Apache-2.0
#include "tests/closed_loop/hazards.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <memory>
#include <random>
#include <thread>

#include "firmware/core/barriers/self_clearance_barrier.hpp"
#include "firmware/core/barriers/solid_barriers.hpp"
#include "tests/support/adversary.hpp"

namespace fovea::test {
namespace {

constexpr double kForEver = 1e6;
constexpr double kStands = 0.02;  // at rest: every joint is slower [rad/s]

class Chance {
 public:
  explicit Chance(std::uint64_t seed) : random_(seed * 2654435761U + 17U) {}
  double Uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  int Whole(int most) { return std::uniform_int_distribution<int>(0, most)(random_); }

 private:
  std::mt19937_64 random_;
};

// From the hazard's beginning on, `spoil` changes each measurement.
void Spoil(HazardCase& c,
           std::function<void(hal::FeatureMeasurement&, const hal::FeatureMeasurement& first)> spoil) {
  const auto onset_ns = static_cast<std::int64_t>(c.onset_s * 1e9);
  auto first = std::make_shared<hal::FeatureMeasurement>();
  c.setup.spoil = [onset_ns, first, spoil = std::move(spoil)](hal::FeatureMeasurement& m) {
    if (m.stamp_ns < onset_ns) {
      return;
    }
    if (!first->found) {
      *first = m;
    }
    spoil(m, *first);
  };
}

void FreezePicture(HazardCase& c) {
  auto random = std::make_shared<std::mt19937_64>(c.seed);
  Spoil(c, [random](hal::FeatureMeasurement& m, const hal::FeatureMeasurement& first) {
    std::normal_distribution<double> noise(0.0, 1e-3);
    m.s = first.s;
    for (std::size_t i = 0; i < 3; ++i) {
      m.s[i] += noise(*random);
    }
    m.same_for_ns = m.stamp_ns - first.stamp_ns;
  });
}

void Mirror(HazardCase& c) {
  Spoil(c, [](hal::FeatureMeasurement& m, const hal::FeatureMeasurement&) { m.s[0] = -m.s[0]; });
}

void Replay(HazardCase& c) {
  auto seen = std::make_shared<std::deque<hal::FeatureMeasurement>>();
  const auto delay = static_cast<std::size_t>(1 + Chance(c.seed).Whole(58));
  const auto onset_ns = static_cast<std::int64_t>(c.onset_s * 1e9);
  c.setup.spoil = [seen, delay, onset_ns](hal::FeatureMeasurement& m) {
    seen->push_back(m);
    if (seen->size() > delay + 1) {
      seen->pop_front();
    }
    if (m.stamp_ns >= onset_ns) {
      m.s = seen->front().s;
    }
  };
}

void OffStamps(HazardCase& c) {
  const auto by_ns = static_cast<std::int64_t>(Chance(c.seed).Uniform(-0.06, 0.06) * 1e9);
  Spoil(c, [by_ns](hal::FeatureMeasurement& m, const hal::FeatureMeasurement&) { m.stamp_ns += by_ns; });
}

void FreezeEncoders(HazardCase& c) { c.setup.arm_faults.stuck = {{c.onset_s, kForEver}, sim::kAllJoints}; }
void FreezeEncoder(HazardCase& c) {
  c.setup.arm_faults.stuck = {{c.onset_s, kForEver}, Chance(c.seed).Whole(6)};
}
void Silence(HazardCase& c) { c.setup.arm_faults.packet_loss = {{c.onset_s, kForEver}, 1.0}; }
void Stall(HazardCase& c) {
  c.setup.stall = {{c.onset_s, c.onset_s + Chance(c.seed).Uniform(0.002, 0.3)}, 1.0, c.seed};
}
void LoseTorque(HazardCase& c) {
  Chance chance(c.seed);
  c.setup.world.torque_loss = {{c.onset_s, kForEver}, chance.Whole(6), chance.Uniform(0.3, 1.0)};
}
void TakeUpLoad(HazardCase& c) {
  c.setup.world.load = {{c.onset_s, kForEver}, Chance(c.seed).Uniform(0.1, 3.0)};
}
void BootWithLoad(HazardCase& c) {
  c.onset_s = 0.0;
  c.setup.servo.auto_track = false;
  c.setup.world.load = {{0.0, kForEver}, Chance(c.seed).Uniform(0.1, 1.5)};
}
void AskForHold(HazardCase& c) { c.holds = true; }

constexpr std::array kHazards{
    Hazard{"hold", "the operator, the dead man's lease or a signal requests a stop", 1.5, AskForHold},
    Hazard{"frozen-picture", "the camera repeats one picture, with fresh noise and fresh stamps", 3.0,
           FreezePicture},
    Hazard{"replayed", "the camera repeats pictures up to 2 s old, with fresh stamps", 3.0, Replay},
    Hazard{"mirrored", "the camera's pictures are mirrored", 3.0, Mirror},
    Hazard{"wrong-stamps", "the camera's stamps are wrong by up to +-60 ms", 3.0, OffStamps},
    Hazard{"frozen-encoders", "all encoders hang, stamps go on", 1.5, FreezeEncoders},
    Hazard{"frozen-encoder", "one encoder hangs", 1.5, FreezeEncoder},
    Hazard{"silent-arm", "the arm sends no more states", 1.5, Silence},
    Hazard{"stalled-computer", "the servo's computer hangs for up to 0.3 s", 1.5, Stall},
    Hazard{"weak-motor", "a joint's motor gives 0 to 70 % of its torque", 1.5, LoseTorque},
    Hazard{"load-taken-up", "the hand picks up an unknown load of 0.1 to 3 kg", 1.5, TakeUpLoad},
    Hazard{"load-from-start", "an unknown load of 0.1 to 1.5 kg from the start; no motion is requested", 1.5,
           BootWithLoad}};

// A random start and target. Only their geometry may reject them.
HazardCase MakeCase(std::uint64_t seed) {
  Chance chance(seed);
  for (;;) {
    HazardCase c;
    c.seed = seed;
    GuardSetup& setup = c.setup;
    setup.servo.auto_track = true;
    setup.world.seed = seed;
    TellTheBench(setup.servo);
    const config::GuardConfig& guard = setup.servo.guard;
    for (Eigen::Index i = 0; i < 7; ++i) {
      setup.world.q_start[i] += chance.Uniform(-0.4, 0.4);
    }
    model::ArmPoses poses;
    model::ComputePoses(setup.servo.arm, setup.world.q_start, poses);
    const model::Pose X_BC = poses.X_BE * setup.servo.X_EC;
    const double z = chance.Uniform(0.3, 0.8);
    const model::Vec3 ball =
        X_BC * model::Vec3(z * chance.Uniform(-0.35, 0.35), z * chance.Uniform(-0.25, 0.25), z);
    c.onset_s = chance.Uniform(0.25, 2.5);
    if (barriers::ClearanceOfArm(setup.servo, poses) > 0.05 &&
        poses.X_BE.p.norm() < guard.workspace_radius - 0.02 &&
        barriers::SelfClearance(setup.servo.arm, barriers::PlaceBodies(setup.servo.arm, poses)) >
            guard.self_clearance &&
        ball.z() > 0.04 && ball.norm() < 0.9) {
      setup.target = [ball](double) { return ball; };
      return c;
    }
  }
}

}  // namespace

std::span<const Hazard> Hazards() { return kHazards; }

HazardOutcome RunCase(const Hazard& hazard, std::uint64_t seed) {
  HazardCase c = MakeCase(seed);
  hazard.inject(c);
  GuardBench bench(c.setup);
  bench.RunUntil(c.onset_s);
  if (c.holds) {
    bench.Ask(task::Request::kHold);
  }
  const Eigen::Vector3d from = bench.truth().X_BE.translation();
  const std::size_t first_tick = bench.ticks().size();
  HazardOutcome outcome;
  Eigen::Vector3d before = from;
  const int watched_ms = static_cast<int>(1e3 * hazard.watched_s);
  for (int ms = 1; ms <= watched_ms; ++ms) {
    bench.RunUntil(c.onset_s + 1e-3 * ms);
    const Eigen::Vector3d now = bench.truth().X_BE.translation();
    outcome.way_mm = std::max(outcome.way_mm, 1e3 * (now - from).norm());
    outcome.speed = std::max(outcome.speed, 1e3 * (now - before).norm());
    outcome.touched = outcome.touched || bench.truth().contacts.Any();
    before = now;
  }
  const hal::Mode mode_then = first_tick > 0 ? bench.ticks()[first_tick - 1].record.mode : hal::Mode::kBoot;
  for (std::size_t k = first_tick; k < bench.ticks().size() && !outcome.noticed; ++k) {
    const hal::TickRecord& r = bench.ticks()[k].record;
    const bool refused = r.intake != hal::Intake::kNone && r.intake != hal::Intake::kTaken;
    if (r.mode == hal::Mode::kFault || r.mode == hal::Mode::kCoast || refused ||
        (r.mode == hal::Mode::kHold && mode_then != hal::Mode::kHold)) {
      outcome.noticed = true;
      outcome.noticed_ms = bench.ticks()[k].ms - static_cast<int>(1e3 * c.onset_s);
    }
  }
  outcome.velocity_share = bench.figures().velocity;
  outcome.stands = bench.speeds().back() < kStands;
  return outcome;
}

HazardFigures RunCases(const Hazard& hazard, int cases, int jobs, std::uint64_t seed,
                       const std::function<void(double share)>& on_progress) {
  std::vector<HazardOutcome> outcomes(static_cast<std::size_t>(cases));
  std::atomic<int> next{0};
  std::vector<std::thread> threads;
  threads.reserve(static_cast<std::size_t>(jobs));
  for (int job = 0; job < jobs; ++job) {
    threads.emplace_back([&] {
      for (int k = next++; k < cases; k = next++) {
        outcomes[static_cast<std::size_t>(k)] = RunCase(hazard, seed + static_cast<std::uint64_t>(k));
      }
    });
  }
  while (on_progress && next < cases) {
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    on_progress(std::min(1.0, static_cast<double>(next) / cases));
  }
  for (std::thread& thread : threads) {
    thread.join();
  }
  HazardFigures f;
  f.cases = cases;
  std::vector<double> ways;
  std::vector<int> noticed_ms;
  for (std::size_t k = 0; k < outcomes.size(); ++k) {
    const HazardOutcome& o = outcomes[k];
    f.noticed += o.noticed ? 1 : 0;
    f.stand += o.stands ? 1 : 0;
    f.touched += o.touched ? 1 : 0;
    f.passed += o.velocity_share > 1.0 ? 1 : 0;
    if (o.noticed) {
      noticed_ms.push_back(o.noticed_ms);
    }
    if (o.way_mm > f.way_most_mm) {
      f.way_most_mm = o.way_mm;
      f.worst_seed = seed + k;
    }
    f.speed_most = std::max(f.speed_most, o.speed);
    if (o.velocity_share > f.joint_most) {
      f.joint_most = o.velocity_share;
      f.joint_seed = seed + k;
    }
    ways.push_back(o.way_mm);
  }
  const auto at = [](auto& values, double share) {
    std::sort(values.begin(), values.end());
    return values.empty() ? 0
                          : values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
  };
  f.way_p50_mm = at(ways, 0.5);
  f.way_p99_mm = at(ways, 0.99);
  f.noticed_p99_ms = at(noticed_ms, 0.99);
  f.noticed_most_ms = at(noticed_ms, 1.0);
  return f;
}

}  // namespace fovea::test
