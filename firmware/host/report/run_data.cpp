// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/report/run_data.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <stdexcept>

#include "firmware/host/recording/log/mcap_reader.hpp"
#include "firmware/host/recording/log/tick_message.hpp"
#include "firmware/host/recording/log/topics.hpp"
#include "firmware/host/report/arm_motion.hpp"
#include "firmware/host/report/feature_path.hpp"
#include "firmware/host/report/frame_losses.hpp"
#include "firmware/host/report/image_error.hpp"
#include "firmware/host/report/scene_reader.hpp"
#include "fovea/hal/record.hpp"
#include "fovea/run.pb.h"
#include "fovea/tick.pb.h"
#include "foxglove/image.pb.h"

namespace fovea::report {
namespace {

constexpr std::size_t kMostBuckets = 1500;
constexpr std::size_t kMostWaiting = 20'000;  // ticks that wait for their truth
constexpr int kMostLimits = 32;               // bits of Tick.limits_active
constexpr double kPauseS = 0.25;              // between two changes of a key that are two events

template <typename Message>
Message Parse(const log::McapMessage& message) {
  Message parsed;
  if (!parsed.ParseFromArray(message.data.data(), static_cast<int>(message.data.size()))) {
    throw std::runtime_error(fmt::format("a message of {} cannot be parsed", message.topic));
  }
  return parsed;
}

// a - b without overflow, for any values in a log.
std::int64_t Apart(std::int64_t a, std::int64_t b) {
  return static_cast<std::int64_t>(static_cast<std::uint64_t>(a) - static_cast<std::uint64_t>(b));
}

class Reader {
 public:
  explicit Reader(RunData& run)
      : run_(run), scene_(run), feature_path_(run.feature_path), frame_losses_(run) {}

  void Take(const log::McapMessage& message) {
    const std::string_view topic = message.topic;
    if (topic == log::kTickTopic) {
      TakeTick(Parse<log::Tick>(message));
    } else if (topic == log::kTruthTopic) {
      truths_.push_back(Parse<log::Truth>(message));
      scene_.AddTruth(truths_.back(), Seconds(truths_.back().stamp_ns()));
      Join(false);
    } else if (topic == log::kTheoryTopic) {
      TakeTheory(Parse<log::Theory>(message));
    } else if (topic == log::kFeatureTopic) {
      TakeFeature(Parse<log::Feature>(message), message.time_ns);
    } else if (topic == log::kSetupTopic) {
      TakeSetup(Parse<log::Setup>(message));
    } else if (topic == log::kConfigurationTopic) {
      TakeConfiguration(Parse<log::ServoConfiguration>(message));
    } else if (topic == log::kImageTopic) {
      TakeImage(message);
    } else if (topic == log::kAnnotationTopic) {
      annotations_[message.time_ns] = Parse<foxglove::ImageAnnotations>(message);
    } else if (topic == log::kCalibrationTopic) {
      const auto calibration = Parse<foxglove::CameraCalibration>(message);
      run_.width_px = static_cast<int>(calibration.width());
      run_.height_px = static_cast<int>(calibration.height());
    } else if (topic == log::kOperatorTopic) {
      const auto touch = Parse<log::Touch>(message);
      run_.touches.push_back({Seconds(touch.stamp_ns()), touch.text()});
    } else if (topic == log::kTickTimesTopic) {
      TakeTickTimes(Parse<log::TickTimes>(message));
    } else if (topic == log::kSceneTopic) {
      scene_.AddScene(Parse<foxglove::SceneUpdate>(message));
    } else if (topic == log::kTransformTopic) {
      scene_.AddTransforms(Parse<foxglove::FrameTransforms>(message), Seconds(message.time_ns));
    }
  }

  void Finish() {
    Join(true);
    for (std::size_t i = 0; i < open_limits_.size(); ++i) {
      if (open_limits_[i]) {
        run_.limits_active[i].spans_s.push_back({*open_limits_[i], run_.duration_s});
      }
    }
    if (!last_image_.empty()) {
      run_.last_frame = MakeFrame(last_image_ns_, last_image_);
    }
    scene_.Finish();
  }

 private:
  // Time since the start of the run [s].
  [[nodiscard]] double Seconds(std::int64_t time_ns) const {
    return static_cast<double>(Apart(time_ns, setup_.start_ns())) * 1e-9;
  }

  void TakeSetup(const log::Setup& setup) {
    if (run_.ticks) {
      throw std::runtime_error("a second set-up");
    }
    if (setup.joints_size() > hal::kMaxJoints || setup.limits_size() > kMostLimits) {
      throw std::runtime_error(fmt::format("a set-up of {} joints and {} limits; at most {} and {} are read",
                                           setup.joints_size(), setup.limits_size(), hal::kMaxJoints,
                                           kMostLimits));
    }
    run_.name = setup.name();
    for (const log::Joint& joint : setup.joints()) {
      run_.joints.push_back(
          {joint.name(), joint.prismatic(), joint.q_min(), joint.q_max(), joint.dq_max(), joint.tau_max()});
    }
    run_.lambda = setup.lambda();
    run_.target_kind = setup.target().empty() ? "sphere" : setup.target();
    run_.target_corners.assign(setup.corners().begin(), setup.corners().end());
    run_.target_radius = setup.target_radius();
    run_.target_moves = setup.target_moves();
    run_.workspace_radius = setup.workspace_radius();
    for (const std::string& name : setup.limits()) {
      run_.limits_active.push_back({name, {}});
    }
    open_limits_.resize(run_.limits_active.size());
    setup_ = setup;
    image_error_ = ImageError(setup);
    feature_path_.Begin(setup);
    run_.error_components = ErrorComponentsOf(setup);
    run_.ticks.emplace(RunData::kJointQuantities * run_.joints.size() + RunData::kNumTickColumns,
                       kMostBuckets);
  }

  // If the configuration is from a later program, the parts that need the arm's model are left out.
  void TakeConfiguration(const log::ServoConfiguration& configuration) {
    try {
      arm_motion_ = ArmMotion(configuration);
    } catch (const std::runtime_error&) {
      arm_motion_ = ArmMotion();
    }
  }

  void TakeTick(const log::Tick& tick) {
    if (!run_.ticks) {
      throw std::runtime_error("a tick comes before the set-up");
    }
    const double t_s = Seconds(tick.stamp_ns());
    run_.duration_s = t_s;
    NoteEvents(tick, t_s);
    if (tick.has_tuning()) {
      NoteTuning(tick.tuning(), t_s);
    }
    for (std::size_t i = 0; i < open_limits_.size(); ++i) {
      const bool acts = ((tick.limits_active() >> i) & 1U) != 0;
      if (acts && !open_limits_[i]) {
        open_limits_[i] = t_s;
      } else if (!acts && open_limits_[i]) {
        run_.limits_active[i].spans_s.push_back({*open_limits_[i], t_s});
        open_limits_[i].reset();
      }
    }
    Row row;
    row.stamp_ns = tick.stamp_ns();
    const auto joints = static_cast<int>(run_.joints.size());
    for (const auto* values : {&tick.arm().q(), &tick.arm().dq(), &tick.command().tau(),
                               &tick.arm().tau_meas(), &tick.tau_ext()}) {
      for (int i = 0; i < joints; ++i) {
        row.values.push_back(i < values->size() ? static_cast<float>((*values)[i]) : kGap);
      }
    }
    const std::size_t at = row.values.size();
    row.values.resize(at + RunData::kNumTickColumns, kGap);
    TakeServo(tick, &row.values[at]);
    waiting_.push_back(std::move(row));
    Join(false);
  }

  // Fills `columns` [kNumTickColumns], except for the truth.
  void TakeServo(const log::Tick& tick, float* columns) const {
    const auto put = [columns](const auto& values, int most, int at) {
      for (int i = 0; i < std::min(values.size(), most); ++i) {
        columns[at + i] = static_cast<float>(values[i]);
      }
    };
    if (tick.target_known()) {
      columns[RunData::kPredictedPx] = image_error_.OfTick(tick);
      put(tick.e(), hal::kMaxFeatureDim, RunData::kError);
    }
    put(tick.v_bc_c_cmd(), 6, RunData::kTwistCmd);
    const ArmMotion::OfTick motion = arm_motion_.At(tick);
    columns[RunData::kPathErrorMm] = motion.path_error_mm;
    std::copy(motion.V_BC_C.begin(), motion.V_BC_C.end(), columns + RunData::kTwistMeas);
  }

  void NoteEvents(const log::Tick& tick, double t_s) {
    const auto mode = static_cast<hal::Mode>(tick.mode());
    const auto reason = static_cast<hal::HoldReason>(tick.hold_reason());
    const std::string mode_name = hal::Name(mode);
    const std::string reason_name = mode == hal::Mode::kHold ? hal::Name(reason) : "";
    if (run_.modes.empty() || run_.modes.back().mode != mode_name ||
        run_.modes.back().reason != reason_name) {
      run_.modes.push_back({t_s, mode_name, reason_name});
    }
    const std::string way = hal::Name(static_cast<hal::Way>(tick.way().kind()));
    const bool begins = run_.ways.empty() && tick.way().kind() == log::Way::LAW;
    if (!begins && (run_.ways.empty() || run_.ways.back().way != way)) {
      run_.ways.push_back({t_s, way, log::InWords(tick.way())});
    }
    const auto fault = static_cast<hal::Fault>(tick.fault());
    if (fault != hal::Fault::kNone && fault != last_fault_) {
      run_.faults.push_back({t_s, hal::Name(fault), hal::Key(fault),
                             tick.fault_joint() >= 0 ? fmt::format("joint {}", tick.fault_joint() + 1) : ""});
    }
    last_fault_ = fault;
  }

  // A slider sends many values: changes of one key without a pause are one event, from the first value to the
  // last.
  void NoteTuning(log::Tuning tuning, double t_s) {
    const bool taken = tuning.result() == log::Tuning::ACCEPTED;
    const bool goes_on = taken && last_tuning_.result() == log::Tuning::ACCEPTED &&
                         last_tuning_.number() == tuning.number() && t_s - last_tuning_s_ < kPauseS;
    if (goes_on) {
      tuning.set_before(last_tuning_.before());
      run_.tunings.back().words = log::InWords(tuning);
    } else {
      run_.tunings.push_back({t_s, taken, log::InWords(tuning)});
    }
    last_tuning_ = std::move(tuning);
    last_tuning_s_ = t_s;
  }

  // Joins each tick with the truth of the same time. The log holds parts of both streams in turn, so ticks
  // wait for their truth.
  void Join(bool last) {
    while (!waiting_.empty()) {
      Row& row = waiting_.front();
      while (!truths_.empty() && truths_.front().stamp_ns() < row.stamp_ns) {
        truths_.pop_front();
      }
      if (truths_.empty() && !last && waiting_.size() < kMostWaiting) {
        return;
      }
      if (!truths_.empty() && truths_.front().stamp_ns() == row.stamp_ns) {
        const std::size_t at = row.values.size() - RunData::kNumTickColumns;
        const double error_px = truths_.front().error_px();
        row.values[at + RunData::kErrorPx] = std::isfinite(error_px) ? static_cast<float>(error_px) : kGap;
        row.values[at + RunData::kErrorMm] = static_cast<float>(truths_.front().error_mm());
        run_.has_truth = true;
      }
      run_.ticks->Add(Seconds(row.stamp_ns), row.values);
      waiting_.pop_front();
    }
  }

  void TakeTheory(const log::Theory& theory) {
    run_.theory.Add(Seconds(theory.stamp_ns()),
                    {static_cast<float>(theory.x()), static_cast<float>(theory.x_goal()),
                     static_cast<float>(theory.x_analytic())});
    run_.has_theory = true;
  }

  void TakeFeature(const log::Feature& feature, std::int64_t taken_ns) {
    frame_losses_.Add(feature, Seconds(feature.stamp_ns()));
    feature_path_.Add(feature, Seconds(feature.stamp_ns()));
    run_.measured.Add(Seconds(feature.stamp_ns()),
                      {image_error_.OfMeasurement(feature),
                       static_cast<float>(1e-6 * static_cast<double>(Apart(taken_ns, feature.stamp_ns()))),
                       static_cast<float>(feature.confidence())});
  }

  void TakeImage(const log::McapMessage& message) {
    last_image_ns_ = message.time_ns;
    last_image_ = Parse<foxglove::CompressedImage>(message).data();
    if (!run_.first_frame) {
      run_.first_frame = MakeFrame(last_image_ns_, last_image_);
    }
    annotations_.erase(annotations_.begin(), annotations_.lower_bound(last_image_ns_));
  }

  EyeFrame MakeFrame(std::int64_t time_ns, const std::string& jpeg) const {
    EyeFrame frame;
    frame.t_s = Seconds(time_ns);
    frame.jpeg = jpeg;
    const auto found = annotations_.find(time_ns);
    if (found == annotations_.end()) {
      return frame;
    }
    for (const foxglove::PointsAnnotation& from : found->second.points()) {
      EyeFrame::Outline outline;
      outline.role = from.metadata_size() > 0 ? from.metadata(0).value() : "";
      for (const foxglove::Point2& point : from.points()) {
        outline.points_px.push_back({point.x(), point.y()});
      }
      frame.outlines.push_back(outline);
    }
    return frame;
  }

  // Makes bars of equal width on a logarithmic axis; the log's own bins are finer than a screen shows.
  void TakeTickTimes(const log::TickTimes& times) {
    constexpr double kBinsPerDecade = 30.0;
    std::map<int, std::uint64_t> bins;
    for (int i = 0; i < std::min(times.upper_ns_size(), times.counts_size()); ++i) {
      const double upper_us = 1e-3 * static_cast<double>(std::max<std::uint64_t>(times.upper_ns(i), 1));
      bins[static_cast<int>(std::ceil(kBinsPerDecade * std::log10(upper_us)))] += times.counts(i);
    }
    for (int bin = bins.empty() ? 0 : bins.begin()->first; !bins.empty() && bin <= bins.rbegin()->first;
         ++bin) {
      run_.tick_upper_us.push_back(std::pow(10.0, bin / kBinsPerDecade));
      run_.tick_counts.push_back(bins.count(bin) == 1 ? bins.at(bin) : 0);
    }
  }

  struct Row {
    std::int64_t stamp_ns = 0;
    std::vector<float> values;
  };

  RunData& run_;
  SceneReader scene_;
  log::Setup setup_;
  ImageError image_error_;
  ArmMotion arm_motion_;
  FeaturePath feature_path_;
  FrameLosses frame_losses_;
  std::deque<Row> waiting_;
  std::deque<log::Truth> truths_;
  std::vector<std::optional<double>> open_limits_;  // time since which each limit is active [s]
  hal::Fault last_fault_ = hal::Fault::kNone;
  log::Tuning last_tuning_;
  double last_tuning_s_ = 0.0;
  std::map<std::int64_t, foxglove::ImageAnnotations> annotations_;
  std::int64_t last_image_ns_ = 0;
  std::string last_image_;
};

}  // namespace

RunData ReadRun(const std::filesystem::path& log_or_folder) {
  const std::filesystem::path path =
      std::filesystem::is_directory(log_or_folder) ? log_or_folder / "log.mcap" : log_or_folder;
  RunData run;
  run.source = path.string();
  Reader reader(run);
  log::McapVisitor visitor;
  visitor.on_message = [&](const log::McapMessage& message) { reader.Take(message); };
  visitor.on_attachment = [&](const log::McapAttachment& attachment) {
    if (attachment.name == "summary.json") {
      run.summary_json = std::string(attachment.data);
    } else if (attachment.media_type == "video/mp4") {
      run.video = std::string(attachment.data);
    }
  };
  visitor.on_metadata = [&](std::string_view name, const std::map<std::string, std::string>& entries) {
    run.metadata[std::string(name)] = entries;
  };
  log::McapEnd end;
  try {
    end = log::ReadMcap(path, visitor);
  } catch (const std::runtime_error& error) {
    const std::string text = error.what();
    throw std::runtime_error(text.rfind(path.string(), 0) == 0 ? text : path.string() + ": " + text);
  }
  run.complete = end.complete;
  run.why_incomplete = end.why;
  if (!run.ticks) {
    throw std::runtime_error(path.string() + ": not the log of a Fovea run: it has no " + log::kSetupTopic);
  }
  reader.Finish();
  return run;
}

}  // namespace fovea::report
