// SPDX-License-Identifier: Apache-2.0
// Lists the fields in which two messages of one type differ, bit by bit.
#pragma once

#include <functional>
#include <string>

namespace google::protobuf {
class Message;
}

namespace fovea::flight {

struct FieldDifference {
  std::string field;  // "command.tau[3]", or "s" when the numbers of entries differ
  std::string a;      // its values
  std::string b;
  double size = 0.0;  // |b - a| of finite numbers (0 for zeros of opposite sign); else infinity
};

// Calls `take` for each field that differs, in the order of the .proto file. A missing field counts as its
// default.
void EachDifference(const google::protobuf::Message& a, const google::protobuf::Message& b,
                    const std::function<void(const FieldDifference&)>& take);

}  // namespace fovea::flight
