// SPDX-License-Identifier: Apache-2.0
#include "tools/fovea/atlas/starts_file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <cmath>
#include <map>
#include <set>

#include "firmware/host/config/input_error.hpp"
#include "firmware/host/config/roll_pitch_yaw.hpp"
#include "tools/fovea/atlas/start_records.hpp"

namespace fovea::atlas {
namespace {

using config::InputError;
using model::Pose;
using model::VecN;

constexpr double kAngleMost = 360.0;  // [deg]
constexpr double kPlaceMost = 5.0;    // of a target, as target.position allows [m]
constexpr double kSeedMost = 2147483647.0;
constexpr std::array<const char*, 6> kPoseNames{"x", "y", "z", "roll", "pitch", "yaw"};

std::vector<std::string> PoseColumns(const std::string& of) {
  std::vector<std::string> columns;
  for (const char* name : kPoseNames) {
    columns.push_back(of + "_" + name);
  }
  return columns;
}

std::vector<std::string> PostureColumns(int num_joints) {
  std::vector<std::string> columns;
  for (int i = 1; i <= num_joints; ++i) {
    columns.push_back(fmt::format("q{}", i));
  }
  return columns;
}

// Reads the columns of one record.
class RecordReader {
 public:
  RecordReader(const std::filesystem::path& file, const StartRecord& record)
      : at_(At(file, record.line)), values_(record.values) {}

  // True if there is any of `columns`. InputError: some are there, but not all.
  bool Has(const std::vector<std::string>& columns) {
    std::vector<std::string> missing;
    for (const std::string& column : columns) {
      known_.insert(column);
      if (!values_.contains(column)) {
        missing.push_back(column);
      }
    }
    if (!missing.empty() && missing.size() < columns.size()) {
      Refuse(fmt::format("column {} is missing: allowed are all of {} or none", missing[0],
                         fmt::join(columns, ", ")));
    }
    return missing.empty();
  }

  double Number(const std::string& column, double least, double most, const char* unit) {
    const double value = values_.at(column);
    if (!(value >= least && value <= most)) {
      Refuse(fmt::format("{} = {} is not allowed: {:.6g} to {:.6g}{}", column, value, least, most, unit));
    }
    return value;
  }

  // x, y, z [m] and roll, pitch, yaw [deg].
  std::array<double, 6> PoseOf(const std::string& of) {
    std::array<double, 6> pose{};
    const std::vector<std::string> columns = PoseColumns(of);
    for (std::size_t i = 0; i < pose.size(); ++i) {
      const bool is_place = i < 3;
      const double most = is_place ? kPlaceMost : kAngleMost;
      pose[i] = Number(columns[i], -most, most, is_place ? " m" : " deg");
    }
    return pose;
  }

  void RefuseOthers() const {
    for (const auto& [column, value] : values_) {
      if (!known_.contains(column)) {
        Refuse(
            fmt::format("column {} is not allowed: q1, q2, ... or camera_x, ..., camera_yaw; target_x, ..., "
                        "target_yaw; goal_x, ..., goal_yaw; seed",
                        Shortened(column)));
      }
    }
  }

  [[noreturn]] void Refuse(const std::string& why) const {
    throw InputError(fmt::format("{}: {}", at_, why));
  }

 private:
  const std::string at_;
  const std::map<std::string, double>& values_;
  std::set<std::string> known_;
};

Pose ToPose(const std::array<double, 6>& values) {
  return {config::RollPitchYaw({values[3], values[4], values[5]}), {values[0], values[1], values[2]}};
}

// The posture of q1, q2, ..., within the joints' ranges.
VecN ReadPosture(const model::ArmModel& arm, RecordReader& reader) {
  VecN q(arm.num_joints);
  const std::vector<std::string> columns = PostureColumns(arm.num_joints);
  for (int i = 0; i < arm.num_joints; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const model::Joint& joint = arm.joints[k];
    q[i] = reader.Number(columns[k], joint.q_min, joint.q_max,
                         joint.type == model::JointType::kPrismatic ? " m" : " rad");
  }
  return q;
}

// Refuses a goal that the simulator would refuse. `scene` has this goal.
void CheckGoal(const Scene& scene, RecordReader& reader) {
  const features::TargetFeature& feature = scene.servo.feature;
  const vision::Intrinsics& camera = scene.camera;
  const model::Vec3& goal = feature.p_CO_C_star;
  if (!(goal.z() > feature.radius)) {
    reader.Refuse(fmt::format(
        "goal_z = {} is not allowed: the target must be wholly in front of the camera, so above {} m",
        goal.z(), feature.radius));
  }
  const auto check_axis = [&](const char* column, double at, double at_px, int size_px) {
    if (!(at_px >= 0.0 && at_px <= size_px - 1)) {
      reader.Refuse(fmt::format(
          "{} = {} is not allowed with goal_z = {}: it is at {:.0f} px, the picture has 0 to {} px", column,
          at, goal.z(), at_px, size_px - 1));
    }
  };
  check_axis("goal_x", goal.x(), camera.U(goal), camera.width_px);
  check_axis("goal_y", goal.y(), camera.V(goal), camera.height_px);
  if (const double distance = goal.norm();
      distance < scene.reach.nearest || distance > scene.reach.farthest) {
    reader.Refuse(
        fmt::format("goal_z = {} is not allowed: the goal's distance is {:.3g} m; vision.distance_min and "
                    "vision.distance_max allow {} to {} m",
                    goal.z(), distance, scene.reach.nearest, scene.reach.farthest));
  }
  if (features::FeatureState state; !feature.ComputeAtGoal(state)) {
    reader.Refuse(
        fmt::format("goal_z = {} is not allowed with these goal_roll and goal_pitch: a part of the target is "
                    "not in front "
                    "of the camera",
                    goal.z()));
  }
}

Start StartOf(const StartRecord& record, const Scene& scene, RecordReader& reader) {
  const model::ArmModel& arm = scene.servo.arm;
  const bool has_posture = reader.Has(PostureColumns(arm.num_joints));
  const bool has_camera = reader.Has(PoseColumns("camera"));
  const bool has_target = reader.Has(PoseColumns("target"));
  const bool has_goal = reader.Has(PoseColumns("goal"));
  const bool has_seed = reader.Has({"seed"});
  reader.RefuseOthers();
  if (has_posture == has_camera) {
    reader.Refuse(fmt::format("needs either q1 to q{} or camera_x to camera_yaw", arm.num_joints));
  }
  if (!has_target) {
    reader.Refuse("column target_x is missing: each start needs target_x to target_yaw");
  }
  Start start;
  start.line = record.line;
  const std::array<double, 6> target = reader.PoseOf("target");
  start.p_BO = {target[0], target[1], target[2]};
  start.rpy_deg = {target[3], target[4], target[5]};
  if (has_goal) {
    const std::array<double, 6> goal = reader.PoseOf("goal");
    start.goal = Goal{{goal[0], goal[1], goal[2]}, {goal[3], goal[4], goal[5]}};
    CheckGoal(WithGoal(scene, *start.goal), reader);
  }
  const double seed = has_seed ? reader.Number("seed", 0.0, kSeedMost, "") : record.line;
  if (seed != std::floor(seed)) {
    reader.Refuse(fmt::format("seed = {} is not allowed: a whole number", seed));
  }
  start.run_seed = static_cast<std::uint32_t>(seed);
  start.way_seed = start.run_seed;
  const Sampler sampler(start.goal ? WithGoal(scene, *start.goal) : scene);
  const StartChecks& checks = sampler.goals().checks();
  const Pose X_BO = start.TargetPose();
  const auto refusal_at = [&](const VecN& q) { return sampler.Refusal(checks.At(q), X_BO); };
  std::optional<VecN> q;
  if (has_posture) {
    q = ReadPosture(arm, reader);
    if (const std::optional<Rejection> refusal = refusal_at(*q)) {
      reader.Refuse(
          fmt::format("no run can begin there: {}", kRejectionWords.at(static_cast<std::size_t>(*refusal))));
    }
  } else {
    q = sampler.goals().WithCameraAt(ToPose(reader.PoseOf("camera")),
                                     [&](const VecN& at) { return !refusal_at(at); });
    if (!q) {
      reader.Refuse(
          "camera_x to camera_yaw: no posture of the arm found that has the camera there, within the joints' "
          "ranges, clear of everything and with the target in sight");
    }
  }
  start.q.assign(q->begin(), q->end());
  sampler.Describe(start);
  return start;
}

}  // namespace

std::vector<Start> ReadStarts(const std::filesystem::path& file, const Scene& scene) {
  std::vector<Start> starts;
  for (const StartRecord& record : ReadStartRecords(file, StartsText(file))) {
    RecordReader reader(file, record);
    starts.push_back(StartOf(record, scene, reader));
  }
  return starts;
}

// FNV-1a, 64 bits.
std::string HashOfFile(const std::filesystem::path& file) {
  std::uint64_t hash = 0xcbf29ce484222325U;
  for (const char c : StartsText(file)) {
    hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3U;
  }
  return fmt::format("{:016x}", hash);
}

}  // namespace fovea::atlas
