// SPDX-License-Identifier: Apache-2.0
// Judges a run against the simulator's truth.
#pragma once

#include <deque>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "fovea/hal/record.hpp"
#include "sim/scenario/commanded_motion.hpp"
#include "sim/scenario/fault_settings.hpp"
#include "sim/verdict/acting_limits.hpp"
#include "sim/verdict/barriers.hpp"
#include "sim/verdict/camera_path.hpp"
#include "sim/verdict/contact_count.hpp"
#include "sim/verdict/limit_book.hpp"
#include "sim/verdict/notice_book.hpp"
#include "sim/verdict/summary.hpp"
#include "sim/verdict/target_error.hpp"
#include "sim/verdict/unwanted_motion.hpp"
#include "sim/world/world.hpp"

namespace fovea::sim {

struct VerdictConfig {
  BarrierConfig barriers;
  StopRules stop;
  JudgedEye eye;
  TargetGoal goal;
  bool has_eye = true;  // false: there is no target to judge
  bool target_moves = false;
  double tracking_bound_px = 3.0;
  double tracking_bound_mm = 5.0;
  double duration_s = 8.0;                // of the run
  bool has_motion = false;                // a motion is commanded, and judged instead of the target
  std::optional<CommandedCircle> circle;  // that the end effector must follow
  double path_bound_mm = 1.0;
  bool goes_home = false;           // the arm must be at arm.q_ready at the end
  std::vector<FaultWindow> faults;  // of the run
};

// Two threads may call AddTruth and AddRecord: they share no data. Memory does not grow with the length of
// the run, except for ticks with a violation.
class Verdict {
 public:
  explicit Verdict(const VerdictConfig& config);

  // `mode`: mode of the servo that commanded this step.
  void AddTruth(const Truth& truth, hal::Mode mode);
  void AddRecord(const hal::TickRecord& record);

  // True if, by the truth so far, it has been within the bounds of `converged` for `time_s`, which is not 0.
  [[nodiscard]] bool HasKeptGoalFor(double time_s) const {
    return time_s > 0.0 && goal_kept_since_s_ && last_s_ - *goal_kept_since_s_ >= time_s;
  }

  // Fills in everything that follows from truth and records. Call it after both threads have ended, and after
  // the number of frames is in `summary`.
  void Fill(Summary& summary) const;

 private:
  struct Sample {
    std::int64_t stamp_ns = 0;
    double error_px = 0.0;                              // infinite if the target is behind the camera
    Eigen::Vector3d error_C = Eigen::Vector3d::Zero();  // goal minus truth, in axes of C [m]
    double judged_m = 0.0;                              // distance to where the goal's picture is true
    double error_rad = 0.0;                             // of the orientation, if the goal has one
  };
  void AddSample(const Sample& sample);
  [[nodiscard]] bool IsAtGoal(double px, double m, double deg) const;
  [[nodiscard]] double WindowPx() const;
  void NoteGoal(double t_s, bool kept);
  void FillEnd(Summary& summary) const;
  void FillMotion(Summary& summary) const;
  void FillStill(Summary& summary) const;
  [[nodiscard]] std::string WhyNotFollowed(const Summary& summary) const;
  void FillMoving(Summary& summary) const;
  static std::string Touched(const Summary& summary);
  [[nodiscard]] std::string WhyNot(const Summary& summary) const;
  [[nodiscard]] std::string WhyNeverAccepted(const Summary& summary) const;
  [[nodiscard]] std::string WhyHeld() const;

  const VerdictConfig config_;

  // from the truth
  double path2_ = 0.0;  // sum of squares of the distance from the commanded circle [m^2]
  double path_most_ = 0.0;
  std::uint64_t path_samples_ = 0;
  TruthBarriers barriers_;
  UnwantedMotion unwanted_;
  std::deque<Sample> window_;       // of the last half second
  std::optional<double> first_px_;  // error at the start
  double most_px_ = 0.0;            // largest error
  CameraPath camera_path_;
  bool is_outside_ = false;  // the last sample was not settled
  std::optional<double> last_outside_s_;
  double second_half_px2_ = 0.0;        // sum of squares of the image error [px^2]
  double second_half_m2_ = 0.0;         // sum of squares of the position error [m^2]
  double second_half_judged_m2_ = 0.0;  // of the distance to where the goal's picture is true [m^2]
  std::uint64_t second_half_samples_ = 0;
  ContactCount contacts_;
  double home_error_ = 0.0;  // largest joint error to arm.q_ready, at the last step [rad]
  std::optional<double> at_rest_since_s_;
  std::optional<double> goal_kept_since_s_;
  double last_s_ = 0.0;  // time of the last truth

  // from the records
  LimitBook reference_;
  std::size_t reference_ddq_ = reference_.Add("joint_acceleration", LimitBook::Kind::kShare);
  std::size_t reference_jerk_ = reference_.Add("joint_jerk", LimitBook::Kind::kShare);
  NoticeBook notices_;
  std::map<std::string, std::uint64_t> limit_ticks_;
  ActingLimits acting_;
  std::map<std::string, std::uint64_t> measurements_;  // count by hal::Intake
  hal::TickRecord before_;
  bool has_record_ = false;
  bool ever_known_ = false;
  std::vector<run::FaultEvent> faults_;
  std::vector<ModeEvent> modes_;
};

}  // namespace fovea::sim
