// SPDX-License-Identifier: Apache-2.0
// What passes between the servo's thread and the planner's: requests one way, plans the other.
#pragma once

#include "firmware/core/trajectory/plan.hpp"
#include "fovea/hal/mailbox.hpp"
#include "fovea/hal/record.hpp"

namespace fovea::trajectory {

// The newest plan wins. The servo judges its stamp.
using PlanMailbox = hal::Mailbox<Plan>;

struct PlanBox {
  hal::Mailbox<hal::TickRecord> requests;  // records of ticks that ask for a plan: see RequestOf
  PlanMailbox plans;
};

}  // namespace fovea::trajectory
