// SPDX-License-Identifier: Apache-2.0
#include "sim/truth/truth_text.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

namespace fovea::sim {

nlohmann::ordered_json TruthAsJson(const std::vector<TrueValue>& truth) {
  nlohmann::ordered_json json = nlohmann::ordered_json::object();
  for (const TrueValue& value : truth) {
    const QuantityInfo& info = InfoOf(value.quantity);
    json[info.key] = {{"unit", info.unit}, {"believed", value.believed}, {"true", value.actual}};
  }
  return json;
}

std::string InWords(const TrueValue& value) {
  double most = 0.0;
  for (std::size_t i = 0; i < value.believed.size(); ++i) {
    const double off = value.actual[i] - value.believed[i];
    most = std::fabs(off) > std::fabs(most) ? off : most;
  }
  const QuantityInfo& info = InfoOf(value.quantity);
  const char* separator = info.unit[0] == '\0' ? "" : " ";
  return fmt::format("{} by {}{:+.3g}{}{}", info.key, value.believed.size() > 1 ? "up to " : "", most,
                     separator, info.unit);
}

}  // namespace fovea::sim
