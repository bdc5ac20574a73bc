// SPDX-License-Identifier: Apache-2.0
// The services and the topics by which viewers change a run: names, schemas, and the reading of requests.
#pragma once

#include <string>
#include <string_view>

#include "firmware/host/live/calls.hpp"
#include "firmware/host/live/catalogue.hpp"

namespace fovea::live {

inline constexpr const char* kTargetPoseTopic = "/target/pose";
inline constexpr const char* kTargetReleaseTopic = "/target/release";

// The JSON schema of a request or an answer, for people's viewers.
struct ServiceSchemas {
  std::string request;
  std::string response;
};
ServiceSchemas SchemasOf(Service service);

// Only a stop needs no control.
inline bool NeedsControl(Service service, const Catalogue& catalogue) {
  return service != Service::kHold && !(service == Service::kEnd && catalogue.anyone_may_end);
}

// `payload`: the JSON of a service call; not for kTakeControl and kGiveControl. Refusal: a field is unknown,
// missing, of the wrong kind or out of range, or names nothing of the catalogue.
Request ReadRequest(Service service, std::string_view payload, const Catalogue& catalogue);
// The name in a request for control; "" when there is none.
std::string ReadControlName(std::string_view payload);
// A message on one of the two topics.
Request ReadTarget(std::string_view topic, std::string_view payload);

}  // namespace fovea::live
