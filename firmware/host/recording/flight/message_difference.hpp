// Where two messages of one type differ, bit by bit, in words.
#pragma once

#include <functional>
#include <string>

namespace google::protobuf {
class Message;
}

namespace fovea::flight {

struct FieldDifference {
  std::string field;  // "command.tau[3]", or "s" where one has more entries than the other
  std::string a;      // its values
  std::string b;
  double size = 0.0;  // |b - a| of numbers that are finite, 0 of zeros of two signs; else infinity
};

// Calls `take` for each field that differs, in the order of their numbers; a field that is not there counts
// as its default.
void EachDifference(const google::protobuf::Message& a, const google::protobuf::Message& b,
                    const std::function<void(const FieldDifference&)>& take);

}  // namespace fovea::flight
