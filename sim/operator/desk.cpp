// SPDX-License-Identifier: Apache-2.0
#include "sim/operator/desk.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <utility>
#include <variant>

#include "firmware/host/config/input_error.hpp"
#include "sim/operator/saved_scenario.hpp"

namespace fovea::sim {
namespace {

// The lowest centre of the target that leaves it above the table [m].
double LeastHeight(const RunDescription& about) {
  const bool is_ball = about.scene.has_eye && about.scene.target.kind == TargetShape::Kind::kBall;
  return is_ball ? about.scene.target.radius : 0.0;
}

Eigen::Vector3d ToVector(const std::array<double, 3>& p) { return {p[0], p[1], p[2]}; }

std::array<double, 3> ToArray(const Eigen::Vector3d& p) { return {p.x(), p.y(), p.z()}; }

std::string InMetres(const Eigen::Vector3d& p) {
  return fmt::format("({:.3f}, {:.3f}, {:.3f}) m", p.x(), p.y(), p.z());
}

std::optional<int> LinkByName(const SimRobot& robot, const std::string& name) {
  for (std::size_t i = 0; i < robot.links.size(); ++i) {
    if (robot.links[i].name == name) {
      return static_cast<int>(i);
    }
  }
  return std::nullopt;
}

live::Answer Refusal(std::string why) { return {std::move(why), "{}"}; }

}  // namespace

OperatorDesk::OperatorDesk(const DeskParts& parts, double speed)
    : parts_(parts),
      pace_(speed),
      hand_(LeastHeight(parts.about)),
      faults_(parts.about.scenario.faults, parts.about.robot.model.num_joints),
      servo_(parts.about.servo, parts.loop, parts.reports) {}

live::Catalogue OperatorDesk::Offer(const RunDescription& about) {
  using live::Service;
  live::Catalogue offer;
  offer.name = about.scenario.name;
  offer.parameters = desk::Tuner(about.servo).parameters();
  offer.tune = true;
  for (const FaultSwitch& fault :
       FaultPanel(about.scenario.faults, about.robot.model.num_joints).Switches(0.0)) {
    live::FaultKind kind{fault.name, fault.meaning, {}};
    for (const FaultSize& size : fault.sizes) {
      kind.settings.push_back({size.name, size.meaning, size.unit, size.min, size.max, size.value});
    }
    offer.faults.push_back(std::move(kind));
  }
  offer.services = {Service::kHold,   Service::kTrack,      Service::kRecover,   Service::kPause,
                    Service::kStep,   Service::kSpeed,      Service::kReset,     Service::kSave,
                    Service::kEnd,    Service::kStartFault, Service::kStopFault, Service::kPull,
                    Service::kRelease};
  offer.target = about.scene.has_eye;
  if (offer.target) {
    offer.services.push_back(Service::kThrow);
  }
  return offer;
}

live::Answer OperatorDesk::Do(const live::Call& call) {
  try {
    return std::visit([this](const auto& request) { return Take(request); }, call.request);
  } catch (const config::InputError& error) {
    return Refusal(error.what());
  }
}

live::Answer OperatorDesk::Take(const live::Pause& request) {
  if (request.paused) {
    pace_.Pause();
  } else {
    pace_.Resume();
  }
  return {};
}

live::Answer OperatorDesk::Take(const live::Step& request) {
  if (!pace_.paused()) {
    return Refusal("the run is not paused");
  }
  pace_.Step(request.ticks);
  return {};
}

live::Answer OperatorDesk::Take(const live::Speed& request) {
  pace_.SetSpeed(request.factor);
  return {};
}

live::Answer OperatorDesk::Take(const live::Reset& /*request*/) {
  end_ = LiveEnd::kReset;
  return {};
}

live::Answer OperatorDesk::Take(const live::End& /*request*/) {
  end_ = LiveEnd::kEnd;
  return {};
}

live::Answer OperatorDesk::Take(const live::Save& /*request*/) {
  PresentState present;
  present.truth = parts_.world.truth();
  present.target_touched = hand_.At(parts_.world.now_ns()).has_value();
  present.tuned = servo_.tuner().Changed();
  present.faults = faults_.faults();
  const std::string name = std::filesystem::path(parts_.about.scenario.name).filename().string();
  const nlohmann::json answer{{"name", fmt::format("{}-at-{:.3f}s.toml", name, now_s())},
                              {"toml", SaveScenario(parts_.about.scenario, present)}};
  return {"", answer.dump(-1, ' ', true, nlohmann::json::error_handler_t::replace)};
}

live::Answer OperatorDesk::Take(const live::StartFault& request) {
  const std::string name = faults_.Switches(now_s()).at(request.fault).name;
  faults_.Start(name, request.sizes, now_s());
  PassFaults();
  std::string text = "fault " + name;
  for (const auto& [size, value] : request.sizes) {
    text += fmt::format(", {} = {:g}", size, value);
  }
  parts_.reports.touch("fault", text);
  return {};
}

live::Answer OperatorDesk::Take(const live::StopFault& request) {
  const std::string name = faults_.Switches(now_s()).at(request.fault).name;
  faults_.Stop(name, now_s());
  PassFaults();
  parts_.reports.touch("fault", fmt::format("fault {} stopped", name));
  return {};
}

void OperatorDesk::PassFaults() {
  const FaultSettings& faults = faults_.faults();
  parts_.world.SetFaults(faults.bench);
  parts_.arm.SetFaults(faults.arm);
  parts_.clock.SetFault(faults.stall);
  parts_.vision.SetFaults(faults);
}

live::Answer OperatorDesk::Take(const live::Pull& request) {
  const std::optional<int> link = LinkByName(parts_.about.scene.robot, request.link);
  if (!link) {
    return Refusal(fmt::format("the arm has no link \"{}\"", request.link));
  }
  if (!spring_) {
    parts_.reports.touch("pull", fmt::format("the arm is pulled at {}", request.link));
  }
  spring_ = ArmSpring{*link, ToVector(request.p_link), ToVector(request.to_B)};
  return {};
}

live::Answer OperatorDesk::Take(const live::Release& /*request*/) {
  LetArmGo();
  return {};
}

void OperatorDesk::LetArmGo() {
  if (spring_) {
    spring_.reset();
    parts_.world.PullAt(Eigen::VectorXd());
    parts_.reports.touch("pull", "the arm is let go");
  }
}

Eigen::Isometry3d OperatorDesk::TargetPose() const {
  Eigen::Isometry3d X_BO = Eigen::Isometry3d::Identity();
  X_BO.translation() = parts_.world.truth().p_BO;
  X_BO.linear() = parts_.world.truth().R_BO;
  return X_BO;
}

live::Answer OperatorDesk::Take(const live::HoldTarget& request) {
  Eigen::Isometry3d wish = Eigen::Isometry3d::Identity();
  wish.translation() = ToVector(request.p_BO);
  const auto& q = request.q_BO;
  wish.linear() = Eigen::Quaterniond(q[0], q[1], q[2], q[3]).toRotationMatrix();
  if (wish.translation().cwiseAbs().maxCoeff() > TargetHand::kFarthest) {
    return Refusal(fmt::format("the target must stay within {:g} m of the base", TargetHand::kFarthest));
  }
  if (!hand_.held()) {
    parts_.reports.touch("target",
                         fmt::format("the target is taken at {}", InMetres(parts_.world.truth().p_BO)));
  }
  hand_.Drag(TargetPose(), wish, parts_.world.now_ns());
  return {};
}

live::Answer OperatorDesk::Take(const live::ReleaseTarget& /*request*/) {
  LetTargetGo();
  return {};
}

void OperatorDesk::LetTargetGo() {
  if (hand_.held()) {
    hand_.Release();
    parts_.reports.touch("target",
                         fmt::format("the target is let go at {}", InMetres(parts_.world.truth().p_BO)));
  }
}

live::Answer OperatorDesk::Take(const live::Throw& request) {
  const Eigen::Vector3d v_BO = ToVector(request.v_BO);
  hand_.Throw(TargetPose(), v_BO, ToVector(request.omega_B), parts_.world.now_ns());
  parts_.reports.touch("target", fmt::format("the target is thrown at {:.2f} m/s",
                                             std::min(v_BO.norm(), TargetHand::kMostSpeed)));
  return {};
}

live::Answer OperatorDesk::Take(const live::ControlEnded& /*request*/) {
  LetTargetGo();
  LetArmGo();
  return {};
}

void OperatorDesk::Act() {
  if (const std::optional<Eigen::Isometry3d> X_BO = hand_.At(parts_.world.now_ns())) {
    parts_.world.PlaceTarget(*X_BO);
  }
  if (spring_) {
    parts_.world.PullAt(
        SpringTorque(*spring_, parts_.about.scene.robot, parts_.world.Look().X_BL, parts_.world.truth().dq));
  }
}

void OperatorDesk::Note(const hal::TickRecord& record) { servo_.Note(record); }

live::State OperatorDesk::State() const {
  const Truth& truth = parts_.world.truth();
  live::State state;
  state.stamp_s = now_s();
  servo_.Fill(state);
  state.paused = pace_.paused();
  state.speed = pace_.speed();
  state.real_time_factor = pace_.achieved();
  state.ends = end_ != LiveEnd::kNone;
  for (const FaultSwitch& fault : faults_.Switches(now_s())) {
    live::FaultState shown{fault.active, {}};
    for (const FaultSize& size : fault.sizes) {
      shown.values.push_back(size.value);
    }
    state.faults.push_back(std::move(shown));
  }
  if (HasTarget()) {
    const Eigen::Quaterniond q(truth.R_BO);
    state.target = live::TargetState{ToArray(truth.p_BO), {q.w(), q.x(), q.y(), q.z()}, hand_.held()};
  }
  if (spring_) {
    const auto link = static_cast<std::size_t>(spring_->link);
    state.pull = live::PullState{parts_.about.scene.robot.links[link].name, ToArray(spring_->p_BT)};
  }
  return state;
}

}  // namespace fovea::sim
