// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/config/key_text.hpp"

#include <fmt/format.h>

#include "firmware/host/config/help_text.hpp"

namespace fovea::config {

std::string KeysAsText(const KeyTable& keys, std::size_t width) {
  constexpr std::size_t kIndent = 4;
  std::string text;
  for (const Key& key : keys.keys()) {
    if (key.meaning.empty()) {
      continue;  // a form of the key before it
    }
    text += Fitted(fmt::format("{} = {}\n{:{}}{}; {}: {}{}{}\n", key.name, key.default_text, "", kIndent,
                               key.meaning, key.kind, key.allowed, key.unit.empty() ? "" : " ", key.unit),
                   kIndent, width);
  }
  return text;
}

}  // namespace fovea::config
