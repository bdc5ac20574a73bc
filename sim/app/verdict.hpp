// Judges a run against the simulator's truth.
#pragma once

#include <vector>

#include "fovea/hal/record.hpp"
#include "fovea/model/arm_model.hpp"
#include "sim/app/summary.hpp"
#include "sim/render/pinhole.hpp"
#include "sim/world/world.hpp"

namespace fovea::sim {

struct VerdictConfig {
  model::ArmModel arm;
  Pinhole pinhole;
  Eigen::Vector3d p_CO_C_star = Eigen::Vector3d::Zero();  // [m]
  bool target_moves = false;
  double tracking_bound_px = 3.0;
  double workspace_radius = 0.85;  // [m]
};

class Verdict {
 public:
  explicit Verdict(const VerdictConfig& config);

  void AddTruth(const Truth& truth);
  void AddRecord(const hal::TickRecord& record);

  // Fills in everything that follows from truth and records.
  void Fill(Summary& summary) const;

 private:
  struct Sample {
    double t_s = 0.0;
    double error_px = 0.0;                              // infinite when the target is behind the camera
    Eigen::Vector3d error_C = Eigen::Vector3d::Zero();  // goal less truth, in axes of C [m]
  };
  void Use(const char* limit, double fraction);
  void FillStill(Summary& summary) const;
  void FillMoving(Summary& summary) const;
  [[nodiscard]] std::string WhyNot(const Summary& summary) const;
  // The samples of the last `share_s` seconds of the run.
  [[nodiscard]] std::vector<Sample> Last(double duration_s) const;

  VerdictConfig config_;
  Eigen::Vector2d goal_px_;
  std::vector<Sample> samples_;
  std::map<std::string, double> limits_;
  std::uint64_t violations_ = 0;
  bool violated_now_ = false;
  std::map<std::string, std::uint64_t> limit_ticks_;
  std::uint64_t contact_ticks_ = 0;
  Eigen::VectorXd tau_before_;
  hal::TickRecord before_;
  bool has_record_ = false;
  bool ever_known_ = false;
  std::vector<FaultEvent> faults_;
  std::vector<ModeEvent> modes_;
};

}  // namespace fovea::sim
