// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/beliefs/findings_json.hpp"

#include <nlohmann/json.hpp>

namespace fovea::beliefs {

nlohmann::ordered_json ToJson(const Findings& findings) {
  using nlohmann::ordered_json;
  ordered_json values = ordered_json::object();
  for (const Belief& belief : findings.beliefs) {
    const bool known = belief.IsKnown();
    values[belief.name] = {
        {"key", belief.key},
        {"unit", belief.unit},
        {"configured", belief.configured ? ordered_json(*belief.configured) : ordered_json(nullptr)},
        {"known", known},
        {"difference", known ? ordered_json(belief.difference) : ordered_json(nullptr)},
        {"sigma", known ? ordered_json(belief.sigma) : ordered_json(nullptr)}};
  }
  ordered_json learnt = ordered_json::array();
  for (const Correction& c : findings.learnt) {
    learnt.push_back(
        {{"t_s", c.t_s}, {"key", c.key}, {"unit", c.unit}, {"from", c.from}, {"to", c.to}, {"text", c.text}});
  }
  return {{"views", findings.views},     {"misfit", findings.misfit}, {"windows", findings.windows},
          {"verdict", findings.verdict}, {"learnt", learnt},          {"values", values}};
}

}  // namespace fovea::beliefs
