// SPDX-License-Identifier: Apache-2.0
// A run's data from its log, thinned to what a page can show.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "firmware/host/report/envelope.hpp"
#include "firmware/host/report/error_components.hpp"
#include "fovea/hal/types.hpp"

namespace fovea::report {

struct JointInfo {
  std::string name;
  bool prismatic = false;
  double q_min = 0.0;
  double q_max = 0.0;
  double dq_max = 0.0;
  double tau_max = 0.0;
};

struct ModeChange {
  double t_s = 0.0;
  std::string mode;
  std::string reason;
};

struct FaultNote {
  double t_s = 0.0;
  std::string name;
  std::string key;
  std::string detail;
};

// Keys that the operator changed, or was refused to change, in motion.
struct TuningEvent {
  double t_s = 0.0;
  bool taken = false;
  std::string words;  // "servo.lambda 2 -> 4 1/s, in motion"
};

// Another request of the operator that acted: hold, a fault, the target.
struct TouchEvent {
  double t_s = 0.0;
  std::string words;
};

// The way to the target changes.
struct WayChange {
  double t_s = 0.0;
  std::string way;  // as hal::Name
  std::string why;  // in words; "" at the start
};

struct LimitSpans {
  std::string name;
  std::vector<std::array<double, 2>> spans_s;  // from, to
};

// One frame of the camera, and the outlines drawn on it.
struct EyeFrame {
  double t_s = 0.0;
  std::string jpeg;
  struct Outline {
    std::string role;
    std::vector<std::array<double, 2>> points_px;
  };
  std::vector<Outline> outlines;
};

// Consecutive frames with a common property.
struct FrameSpan {
  double from_s = 0.0;
  double to_s = 0.0;
  std::uint64_t frames = 0;
};

// Points in the picture over time.
struct PixelPath {
  std::vector<float> goal_px;  // [2 N] u, v of each point's goal; NaN: not in the picture
  std::vector<float> t_s;      // [F]
  std::vector<float> px;       // [F * 2 N]; NaN: not found
};

struct SceneShape {
  std::string kind;             // "box", "cylinder", "sphere", "mesh"
  std::vector<double> size;     // box: x, y, z; cylinder: radius, length; sphere: radius [m]
  std::vector<float> vertices;  // mesh: x, y, z of each corner of each triangle [m]
  std::array<double, 3> position{};
  std::array<double, 4> quaternion{1.0, 0.0, 0.0, 0.0};  // w, x, y, z
  std::array<double, 3> colour{};                        // gamma-encoded, 0 to 1
};

struct SceneLink {
  std::string frame;
  std::vector<SceneShape> shapes;
};

// Poses in B of all links, evenly spaced in time.
struct SceneMotion {
  std::vector<float> t_s;          // [F]
  std::vector<float> poses;        // [F * links * 7] x, y, z, qw, qx, qy, qz
  std::vector<float> camera_path;  // [F * 3]
  std::vector<float> target_path;  // [F * 3]; NaN: unknown
  std::vector<float> target_turn;  // [F * 4] w, x, y, z of its orientation in B; NaN: unknown
};

struct RunData {
  std::string source;  // the log's path
  bool complete = false;
  std::string why_incomplete;

  // /setup
  std::string name;
  std::vector<JointInfo> joints;
  double lambda = 0.0;
  std::string target_kind;             // "sphere", "circle", "square", "triangle"
  double target_radius = 0.0;          // of the sphere that encloses it [m]; 0: no target
  std::vector<double> target_corners;  // x, y of each in O [m]; empty for a round target
  bool target_moves = false;
  double workspace_radius = 0.0;
  double duration_s = 0.0;  // of the records in the log
  int width_px = 0;
  int height_px = 0;

  std::map<std::string, std::map<std::string, std::string>> metadata;
  std::optional<std::string> summary_json;
  std::optional<std::string> video;

  // Columns of `ticks`: q, dq, tau, tau_meas, tau_ext of each joint, then these.
  static constexpr std::size_t kJointQuantities = 5;
  enum TickColumn : std::uint8_t {
    kErrorPx,
    kErrorMm,
    kPredictedPx,
    kPathErrorMm,
    kTwistCmd,                   // V_BC_C_cmd, 6 columns
    kTwistMeas = kTwistCmd + 6,  // the same, computed from the measured joints
    kError = kTwistMeas + 6,     // e, in the order of error_components
    kNumTickColumns = kError + hal::kMaxFeatureDim
  };
  std::optional<Envelope> ticks;
  std::vector<ErrorComponent> error_components;
  bool has_truth = false;
  // Columns of `measured`.
  enum MeasuredColumn : std::uint8_t { kMeasuredPx, kAgeMs, kConfidence, kNumMeasuredColumns };
  Envelope measured{kNumMeasuredColumns, 1500};
  // Columns of `theory`: a one-joint arm, its goal, and its analytic solution; empty for all other runs.
  enum TheoryColumn : std::uint8_t { kTheoryX, kTheoryGoal, kTheoryAnalytic, kNumTheoryColumns };
  Envelope theory{kNumTheoryColumns, 1500};
  bool has_theory = false;
  PixelPath feature_path;
  std::uint64_t frames_taken = 0;    // frames whose measurement reached the servo
  std::vector<FrameSpan> lost;       // frames between two of them that did not reach the servo
  std::vector<FrameSpan> not_found;  // in which the target was not found
  std::vector<ModeChange> modes;
  std::vector<WayChange> ways;  // empty if the arm never left the visual law
  std::vector<FaultNote> faults;
  std::vector<TuningEvent> tunings;
  std::vector<TouchEvent> touches;
  std::vector<LimitSpans> limits_active;
  std::vector<double> tick_upper_us;
  std::vector<std::uint64_t> tick_counts;
  std::optional<EyeFrame> first_frame;
  std::optional<EyeFrame> last_frame;
  std::vector<SceneLink> links;
  SceneMotion motion;
};

// Reads a log, or the log in a run's folder. Reads a truncated log up to the cut. std::runtime_error, naming
// the file: it cannot be read, is no MCAP file, or is not the log of a Fovea run.
RunData ReadRun(const std::filesystem::path& log_or_folder);

}  // namespace fovea::report
