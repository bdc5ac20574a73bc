// SPDX-License-Identifier: Apache-2.0
// Charts of a contact study, as SVG.
#pragma once

#include <string>

#include "tools/fovea/contact/study.hpp"

namespace fovea::contact {

// The ROC of the runs with wrong beliefs: detected share of the pushes at the hand over false alarms per
// hour, one line per force. Solid: the servo's detector; dashed: the total torque alone. A ring marks the
// default.
std::string RocChart(const Study& study);

// The detected share over the threshold, for pushes at `place`. A vertical line marks the default.
std::string DetectionChart(const Study& study, Place place);

// False alarms per hour over the threshold, with right and with wrong beliefs.
std::string AlarmChart(const Study& study);

// The colours of the lines, for a legend in HTML.
std::string ForceLegend();

}  // namespace fovea::contact
