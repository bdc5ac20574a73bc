#include "firmware/host/config/key_text.hpp"

#include <fmt/format.h>

namespace fovea::config {

std::string KeysAsText(const KeyTable& keys) {
  std::string text;
  for (const Key& key : keys.keys()) {
    text += fmt::format("{} = {}\n    {}; {}: {}{}{}\n", key.name, key.default_text, key.meaning, key.kind,
                        key.allowed, key.unit.empty() ? "" : " ", key.unit);
  }
  return text;
}

}  // namespace fovea::config
