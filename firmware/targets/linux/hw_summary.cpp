#include "hw_summary.hpp"

#include <nlohmann/json.hpp>

namespace fovea::hw {

std::string ToJson(const HwSummary& s) {
  using Json = nlohmann::ordered_json;
  Json json{
      {"config", s.config},
      {"mode", hal::Name(s.mode)},
      {"fault", hal::Name(s.fault)},
      {"events", s.events},
      {"ticks", s.loop.ticks},
      {"overruns", s.loop.overruns},
      {"missed_ticks", s.loop.missed_ticks},
      {"heap_allocations_in_tick", s.heap_counted ? Json(s.heap_calls) : Json(nullptr)},
      {"page_faults_in_loop", s.page_faults},
      {"tick_ns",
       {{"p50", s.ticks.Percentile(0.5)},
        {"p99", s.ticks.Percentile(0.99)},
        {"p999", s.ticks.Percentile(0.999)},
        {"max", s.ticks.max_ns()}}},
      {"robot",
       {{"states", s.robot.states},
        {"lost_states", s.robot.lost_states},
        {"late_states", s.robot.late_states},
        {"duplicate_states", s.robot.duplicate_states},
        {"skipped_states", s.robot.skipped_states},
        {"malformed", s.robot.malformed},
        {"foreign", s.robot.foreign},
        {"commands", s.robot.commands},
        {"repeated_commands", s.robot.repeated_commands},
        {"rate_limited", s.robot.rate_limited},
        {"timeouts", s.robot.timeouts},
        {"motions", s.robot.motions},
        {"command_success_rate", s.success_rate}}},
      {"realtime_missing", s.realtime_missing},
  };
  if (s.seen) {
    json["camera"] = {{"frames", s.seen->frames},
                      {"frames_detected", s.seen->frames_detected},
                      {"seen_error_px", s.seen->last_px ? Json(*s.seen->last_px) : Json(nullptr)},
                      {"incomplete", s.camera.incomplete},
                      {"lost", s.camera.lost},
                      {"overtaken", s.camera.overtaken},
                      {"missing_packets", s.camera.missing_packets},
                      {"disconnects", s.camera.disconnects},
                      {"reconnects", s.camera.reconnects}};
  }
  return json.dump(2) + "\n";
}

}  // namespace fovea::hw
