// SPDX-License-Identifier: Apache-2.0
#include "firmware/targets/linux/check_camera.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "firmware/host/config/input_error.hpp"
#include "firmware/targets/linux/cameras/camera_driver.hpp"
#include "firmware/targets/linux/frame_figures.hpp"
#include "fovea/camera/camera_error.hpp"
#include "fovea/linux_rt/monotonic_clock.hpp"

namespace fovea::hw {
namespace {

using Rows = std::vector<CheckRow>;

constexpr double kRmsWarnPx = 0.5;
constexpr double kRmsFailPx = 2.0;
constexpr double kMountWarnMm = 2.0;
constexpr double kMountFailMm = 10.0;
constexpr double kRateWarn = 0.95;  // of the requested rate
constexpr double kRateFail = 0.7;
constexpr double kLostFail = 0.02;                 // share of all frames
constexpr double kLateWarn = 0.02;                 // share of all frames
constexpr std::int64_t kFirstNs = 3'000'000'000;   // timeout for the first frame
constexpr std::int64_t kPatienceNs = 200'000'000;  // timeout for each later frame
constexpr const char* kNetwork =
    "GigE: check camera.packet_size, the MTU and net.core.rmem_max; avoid other traffic; use fewer pixels";

Verdict Grade(double value, double warn, double fail) {
  return value < warn ? Verdict::kPass : value < fail ? Verdict::kWarn : Verdict::kFail;
}

void CheckCalibration(const config::CalibrationSettings& settings, Rows& rows) {
  const char* const advice = "run `fovea calibrate intrinsics` on pictures of a board; copy its output";
  try {
    const vision::Intrinsics in = config::MakeIntrinsics(settings);
    if (settings.rms_px == 0.0) {
      rows.push_back({"calibration", Verdict::kWarn,
                      fmt::format("f {:.1f} px; its rms error is unknown", in.f_u_px), advice});
    } else {
      const Verdict verdict = Grade(settings.rms_px, kRmsWarnPx, kRmsFailPx);
      rows.push_back({"calibration", verdict,
                      fmt::format("f {:.1f} px, its views fit to {:.3g} px rms", in.f_u_px, settings.rms_px),
                      verdict == Verdict::kPass ? "" : advice});
    }
  } catch (const config::InputError& error) {
    rows.push_back({"calibration", Verdict::kFail, error.what(), advice});
  }
  const auto is_zero = [](const std::vector<double>& values) {
    return std::all_of(values.begin(), values.end(), [](double value) { return value == 0.0; });
  };
  const char* const mount_advice =
      "run `fovea calibrate hand-eye`; set camera.mount_xyz, mount_rpy_deg and mount_rms_mm from its output";
  if (is_zero(settings.mount_xyz) && is_zero(settings.mount_rpy_deg)) {
    rows.push_back(
        {"mounting", Verdict::kFail, "the configured position is the flange's centre", mount_advice});
  } else if (settings.mount_rms_mm == 0.0) {
    rows.push_back({"mounting", Verdict::kWarn, "its rms error is unknown", mount_advice});
  } else {
    const Verdict verdict = Grade(settings.mount_rms_mm, kMountWarnMm, kMountFailMm);
    rows.push_back({"mounting", verdict,
                    fmt::format("its views agree to {:.3g} mm rms", settings.mount_rms_mm),
                    verdict == Verdict::kPass ? "" : mount_advice});
  }
}

void CheckRate(const HwConfig& config, const FrameFigures& figures, Rows& rows) {
  const double wished_hz = config.camera.rate_hz;
  if (wished_hz == 0.0) {
    rows.push_back({"camera's rate", Verdict::kPass, fmt::format("{:.1f} Hz", figures.rate_hz), ""});
    return;
  }
  const double share = figures.rate_hz / wished_hz;
  const Verdict verdict = share > kRateWarn   ? Verdict::kPass
                          : share > kRateFail ? Verdict::kWarn
                                              : Verdict::kFail;
  rows.push_back(
      {"camera's rate", verdict, fmt::format("{:.1f} Hz, {:.1f} requested", figures.rate_hz, wished_hz),
       verdict == Verdict::kPass ? "" : "shorten camera.exposure_ms; use a faster line or fewer pixels"});
}

void CheckLosses(const CameraCounters& counters, std::size_t frames, int late, Rows& rows) {
  const auto lost = static_cast<double>(counters.lost + counters.incomplete);
  const auto came = static_cast<double>(frames);
  const Verdict verdict = lost > kLostFail * (came + lost)      ? Verdict::kFail
                          : lost > 0 || late > kLateWarn * came ? Verdict::kWarn
                                                                : Verdict::kPass;
  rows.push_back(
      {"frames", verdict,
       fmt::format("{} came, {} lost, {} damaged, {} late", frames, counters.lost, counters.incomplete, late),
       verdict == Verdict::kPass ? "" : kNetwork});
}

void CheckLatency(const HwConfig& config, const FrameFigures& figures, bool by_clock, Rows& rows) {
  if (config.camera.time != "computer" || config.camera.driver == "recorded") {
    rows.push_back({"latency", Verdict::kWarn, "not measured: the stamps are from another clock",
                    "set camera.time = \"computer\" to measure it"});
    return;
  }
  const double stale_ms = 1e3 * config.servo.config.predict.stale_s;
  const Verdict verdict = Grade(figures.latency_max_ms + figures.period_ms, stale_ms,
                                stale_ms + figures.latency_max_ms - figures.latency_ms);
  rows.push_back(
      {"latency", verdict,
       fmt::format("{:.1f} ms from exposure to arrival, at most {:.1f} ms, by {}", figures.latency_ms,
                   figures.latency_max_ms, by_clock ? "the camera's own clock" : "camera.transport_ms"),
       verdict == Verdict::kPass
           ? ""
           : fmt::format("latency plus the period of {:.1f} ms reaches servo.stale_s, which is {:.0f} ms",
                         figures.period_ms, stale_ms)});
}

void CheckFrames(const HwConfig& config, Rows& rows) {
  linux_rt::MonotonicClock clock;
  const std::unique_ptr<CameraDriver> camera = OpenCamera(config, clock.NowNs());
  rows.push_back({"camera", Verdict::kPass, camera->name(), ""});
  std::vector<Arrival> arrivals;
  std::uint64_t lost_before = 0;  // until the first frame came
  hal::Frame frame;
  hal::Status status = camera->camera().Acquire(frame, kFirstNs);
  const std::int64_t end_ns =
      clock.NowNs() +
      static_cast<std::int64_t>(config.check.seconds * static_cast<double>(hal::kNsPerSecond));
  while (clock.NowNs() < end_ns && (status.ok() || status.code() == hal::StatusCode::kTimeout)) {
    if (status.ok()) {
      lost_before = arrivals.empty() ? camera->counters().lost : lost_before;
      arrivals.push_back({frame.stamp_ns, clock.NowNs()});
    }
    status = camera->camera().Acquire(frame, kPatienceNs);
  }
  if (arrivals.size() < 2) {
    rows.push_back({"frames", Verdict::kFail,
                    fmt::format("{} came in {:.1f} s", arrivals.size(), config.check.seconds),
                    "check for an external trigger; set a longer check.seconds; check camera.exposure_ms"});
    return;
  }
  CameraCounters counters = camera->counters();
  counters.lost -= lost_before;
  const FrameFigures figures = FiguresOf(arrivals);
  const vision::Intrinsics& in = config.camera.calibration.intrinsics;
  if (frame.width_px != in.width_px || frame.height_px != in.height_px) {
    rows.push_back({"picture size", Verdict::kFail,
                    fmt::format("{} x {} px, calibrated for {} x {} px", frame.width_px, frame.height_px,
                                in.width_px, in.height_px),
                    "calibrate the camera at the size in use"});
  }
  CheckRate(config, figures, rows);
  CheckLosses(counters, arrivals.size(), figures.late, rows);
  CheckLatency(config, figures, counters.stamped_by_clock > 0, rows);
}

}  // namespace

void CheckCamera(const HwConfig& config, Rows& rows) {
  if (!config.HasCamera()) {
    rows.push_back({"camera", Verdict::kWarn, "none: the arm is held where it stands", "set camera.driver"});
    return;
  }
  CheckCalibration(config.camera.calibration, rows);
  try {
    CheckFrames(config, rows);
  } catch (const camera::CameraError& error) {
    rows.push_back(
        {"camera", Verdict::kFail, error.what(),
         "check power, cable and camera.device; `arv-tool-0.8` or `v4l2-ctl --list-devices` lists cameras"});
  }
}

}  // namespace fovea::hw
