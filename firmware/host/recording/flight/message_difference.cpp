// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/recording/flight/message_difference.hpp"

#include <fmt/format.h>
#include <google/protobuf/descriptor.h>
#include <google/protobuf/message.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

namespace fovea::flight {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;
using google::protobuf::Reflection;

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

// A field's value, or one entry of a repeated field.
struct Value {
  std::string text;
  std::string bits;       // equal only for equal values
  double number = kNone;  // NaN when the value is not a number
};

Value OfNumber(double number) {
  return {fmt::format("{}", number), std::to_string(std::bit_cast<std::uint64_t>(number)), number};
}
Value OfText(const std::string& text) { return {fmt::format("{} bytes", text.size()), text, kNone}; }
template <typename Integer>
Value OfInteger(Integer value) {
  return {fmt::format("{}", value), fmt::format("{}", value), static_cast<double>(value)};
}
// A set of flags, not a number.
Value OfBits(std::uint32_t value) { return {fmt::format("{:#x}", value), fmt::format("{}", value), kNone}; }

Value Get(const Message& m, const FieldDescriptor& f, int i) {
  const Reflection& r = *m.GetReflection();
  const bool many = f.is_repeated();
  switch (f.cpp_type()) {
    case FieldDescriptor::CPPTYPE_DOUBLE:
      return OfNumber(many ? r.GetRepeatedDouble(m, &f, i) : r.GetDouble(m, &f));
    case FieldDescriptor::CPPTYPE_INT32:
      return OfInteger(many ? r.GetRepeatedInt32(m, &f, i) : r.GetInt32(m, &f));
    case FieldDescriptor::CPPTYPE_UINT32:
      return OfBits(many ? r.GetRepeatedUInt32(m, &f, i) : r.GetUInt32(m, &f));
    case FieldDescriptor::CPPTYPE_INT64:
      return OfInteger(many ? r.GetRepeatedInt64(m, &f, i) : r.GetInt64(m, &f));
    case FieldDescriptor::CPPTYPE_UINT64:
      return OfInteger(many ? r.GetRepeatedUInt64(m, &f, i) : r.GetUInt64(m, &f));
    case FieldDescriptor::CPPTYPE_BOOL: {
      const bool value = many ? r.GetRepeatedBool(m, &f, i) : r.GetBool(m, &f);
      return {value ? "true" : "false", value ? "1" : "0", kNone};
    }
    case FieldDescriptor::CPPTYPE_ENUM: {
      const std::string& name = (many ? r.GetRepeatedEnum(m, &f, i) : r.GetEnum(m, &f))->name();
      return {name, name, kNone};
    }
    case FieldDescriptor::CPPTYPE_STRING:
      return OfText(many ? r.GetRepeatedString(m, &f, i) : r.GetString(m, &f));
    default: return {"?", "", kNone};
  }
}

class Walk {
 public:
  explicit Walk(const std::function<void(const FieldDifference&)>& take) : take_(take) {}

  void Compare(const Message& a, const Message& b, const std::string& prefix) const {
    const auto& type = *a.GetDescriptor();
    for (int k = 0; k < type.field_count(); ++k) {
      const FieldDescriptor& field = *type.field(k);
      const std::string name = prefix + field.name();
      const bool nested = field.cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE;
      if (!field.is_repeated()) {
        if (nested) {
          Compare(a.GetReflection()->GetMessage(a, &field), b.GetReflection()->GetMessage(b, &field),
                  name + ".");
        } else {
          CompareValues(Get(a, field, 0), Get(b, field, 0), name);
        }
        continue;
      }
      const int size = a.GetReflection()->FieldSize(a, &field);
      const int size_b = b.GetReflection()->FieldSize(b, &field);
      if (size != size_b) {
        take_({name, fmt::format("{} entries", size), fmt::format("{} entries", size_b), kInfinite});
        continue;
      }
      for (int i = 0; i < size; ++i) {
        const std::string entry = fmt::format("{}[{}]", name, i);
        if (nested) {
          Compare(a.GetReflection()->GetRepeatedMessage(a, &field, i),
                  b.GetReflection()->GetRepeatedMessage(b, &field, i), entry + ".");
        } else {
          CompareValues(Get(a, field, i), Get(b, field, i), entry);
        }
      }
    }
  }

 private:
  void CompareValues(const Value& a, const Value& b, const std::string& name) const {
    if (a.bits != b.bits) {
      const double size = std::fabs(b.number - a.number);
      take_({name, a.text, b.text, std::isfinite(size) ? size : kInfinite});
    }
  }

  const std::function<void(const FieldDifference&)>& take_;
};

}  // namespace

void EachDifference(const Message& a, const Message& b,
                    const std::function<void(const FieldDifference&)>& take) {
  Walk(take).Compare(a, b, "");
}

}  // namespace fovea::flight
