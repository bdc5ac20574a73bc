// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "tools/fovea/contact/text.hpp"

namespace fovea::contact {
namespace {

constexpr const char* kHead = R"(# Detection of contact

Printed by `fovea atlas --contact --markdown`. The servo stops the arm with the fault `contact` when the external torque on a
joint exceeds `safety.contact_torque_fraction` of its largest torque, or changes by more than
`safety.contact_sudden_fraction` of it within about 0.2 s. An observer estimates this torque from the arm's momentum.
Wrong masses also look like external torques. This page shows how often that leads to a false alarm, and which pushes are
detected. The exit code is 1 after a false alarm of the default detector, or if the arm does not stop after a push of the
largest force at the hand.

)";

constexpr const char* kChoice = R"(
A lower threshold detects more pushes, but takes a load for one. At 10 % a load of 1 kg that the hand picks up stops the arm,
which the default carries:

```
fovea-sim run ball --set 'faults.load_s=[3, 4]' --set faults.load_mass=1 --set safety.contact_sudden_fraction=0.05
```

Where nothing is picked up, a lower `safety.contact_sudden_fraction` is worth a try. Alone, without a lower limit of the total
torque, it was not measured.
)";

constexpr const char* kHow = R"(
The arm is a Panda. In the simulated runs its contact check is off; the recorded external torque is then judged with the
servo's own code, for every threshold. A run without a push gives false alarms: an alarm ends when the torque has been below
the threshold for 0.5 s. In a run with a push, a force of random direction acts for 0.3 s, at a random time of the motion, on
the flange or on the elbow (link 4), as constant joint torques. It is detected if the torque rises above the threshold
within this time. "By others": another guard stopped the arm before, such as `joint_velocity` when a push accelerates a joint
more than its motor could.

Wrong beliefs: each link's mass is wrong by up to 20 % (two of the six draws: all by +20 %, all by -20 %), the load by
-0.2 to +0.3 kg, viscous and Coulomb friction by up to 50 %. Motions: `home` (to the ready posture), `circle` (the flange on
a circle), `waves` (all joints to and fro), `track` (visual servoing on a moving ball).
)";

std::string RateRow(const char* beliefs, const Runs& runs, Detector detector, std::size_t threshold) {
  return fmt::format("| {} | {} |\n", beliefs, InWords(CountAlarms(runs.quiet, detector, threshold)));
}

std::string PushTable(const Study& study, Detector detector) {
  std::string text = "| pushed at | beliefs |";
  for (const double force : kForces) {
    text += fmt::format(" {:g} N |", force);
  }
  text += "\n|---|---|---|---|---|---|\n";
  for (const Place place : kPlaces) {
    for (const auto& [name, runs] :
         {std::pair<const char*, const Runs&>{"right", study.right}, {"wrong", study.wrong}}) {
      const auto& pushed = runs.pushed.at(static_cast<std::size_t>(place));
      if (pushed.front().empty()) {
        continue;
      }
      text += fmt::format("| {} | {} |", Name(place), name);
      for (const auto& of_force : pushed) {
        text += fmt::format(" {} |", InWords(Detect(of_force, detector, study.threshold)));
      }
      text += "\n";
    }
  }
  return text;
}

std::string ThresholdTable(const Study& study) {
  std::string text =
      "| threshold | detector | false alarms per hour | hand, 10 N | 20 N | 40 N | elbow, 40 N |\n"
      "|---|---|---|---|---|---|---|\n";
  for (const int percent : {3, 5, 7, 10, 15, 20, 30, 40}) {
    const std::size_t i = NearestThreshold(0.01 * percent);
    for (const Detector detector : {Detector::kTotal, Detector::kBoth}) {
      text += fmt::format("| {} %{} | {} | {:.0f} |", percent,
                          i == study.threshold && detector == Detector::kBoth ? " (default)" : "",
                          detector == Detector::kTotal ? "total torque alone" : "servo's",
                          CountAlarms(study.wrong.quiet, detector, i).PerHour());
      const auto& hand = study.wrong.pushed.at(static_cast<std::size_t>(Place::kHand));
      const auto& elbow = study.wrong.pushed.at(static_cast<std::size_t>(Place::kElbow));
      for (const auto* pushed : {&hand[1], &hand[2], &hand[3], &elbow[3]}) {
        text += fmt::format(" {:.0f} % |", 100.0 * Detect(*pushed, detector, i).Share());
      }
      text += "\n";
    }
  }
  return text;
}

}  // namespace

std::string ToMarkdown(const Study& study) {
  std::string text = kHead;
  text += fmt::format(
      "{} runs, seed {}.\n\n## The default detector\n\n| beliefs | false alarms while the arm moves |\n"
      "|---|---|\n",
      study.runs, study.seed);
  text += RateRow("right", study.right, Detector::kBoth, study.threshold) +
          RateRow("wrong", study.wrong, Detector::kBoth, study.threshold);
  text += "\nPushes after which the arm stops, with the median (and longest) time until detection:\n\n" +
          PushTable(study, Detector::kBoth);
  text += fmt::format("\nThe same with the limit of the total torque ({:g}) alone:\n\n",
                      ThresholdAt(study.threshold)) +
          PushTable(study, Detector::kTotal);
  text +=
      fmt::format(
          "\n## Other thresholds, with wrong beliefs\n\nThe servo's detector at a threshold has a limit of a "
          "sudden torque that is {:g} times lower.\n\n",
          study.sudden_weight) +
      ThresholdTable(study);
  text += kChoice;
  text += "\n## How it is measured\n";
  text += kHow;
  return text + fmt::format("\nOne of the runs:\n\n```\n{}\n```\n", study.command);
}

}  // namespace fovea::contact
