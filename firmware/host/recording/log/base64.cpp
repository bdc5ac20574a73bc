// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/recording/log/base64.hpp"

#include <openssl/evp.h>

namespace fovea::log {

std::string Base64(std::string_view bytes) {
  std::string text((bytes.size() + 2) / 3 * 4 + 1, '\0');  // plus the 0 that OpenSSL appends
  EVP_EncodeBlock(reinterpret_cast<unsigned char*>(text.data()),
                  reinterpret_cast<const unsigned char*>(bytes.data()), static_cast<int>(bytes.size()));
  text.pop_back();
  return text;
}

}  // namespace fovea::log
