// SPDX-License-Identifier: Apache-2.0
// The lists of fields are complete: every member of a struct is in its list.
#include "firmware/core/config/fields.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstring>
#include <limits>
#include <new>
#include <set>
#include <string>
#include <vector>

#include "firmware/core/config/range_check.hpp"
#include "firmware/core/config/servo_config.hpp"
#include "firmware/core/link/config_fields.hpp"
#include "firmware/core/task/servo_task.hpp"
#include "tests/support/panda.hpp"

namespace fovea::config {
namespace {

// A visitor that records which bytes it visits.
class SeenBytes {
 public:
  SeenBytes(const void* begin, std::size_t size)
      : begin_(static_cast<const std::byte*>(begin)), seen_(size, false) {}

  template <class... Args>
  void Flag(const Field& /*field*/, Args&... args) {
    (Note(args), ...);
  }
  template <class T>
  void Number(const Field& /*field*/, T& value, double /*min*/, double /*max*/) {
    Note(value);
  }
  template <class T>
  void Integer(const Field& /*field*/, T& value, int /*min*/, int /*max*/) {
    Note(value);
  }
  template <class T, class Names>
  void Choice(const Field& /*field*/, T& value, const Names& /*names*/) {
    Note(value);
  }
  template <class T>
  void PerJoint(const Field& /*field*/, T& value, double /*min*/, double /*max*/) {
    Note(value);
  }
  template <class T>
  void Count(const Field& /*field*/, T& value, int /*most*/) {
    Note(value);
  }
  template <class T>
  void Derived(const Field& /*field*/, T& value, double /*min*/ = 0.0, double /*max*/ = 0.0) {
    Note(value);
  }

  // As an archive of link::FieldsOf.
  template <class T>
  void operator()(T& value) {
    Note(value);
  }
  template <class T>
  void Int(T& value) {
    Note(value);
  }
  template <class T>
  void Choice(T& value, int /*count*/) {
    Note(value);
  }
  template <class T>
  void Count(T& value, int /*most*/) {
    Note(value);
  }

  [[nodiscard]] const std::vector<bool>& seen() const { return seen_; }

 private:
  template <class T>
  void Note(T& value) {
    const auto at = static_cast<std::size_t>(reinterpret_cast<const std::byte*>(&value) - begin_);
    for (std::size_t i = at; i < at + sizeof(T); ++i) {
      seen_.at(i) = true;
    }
  }

  const std::byte* begin_;
  std::vector<bool> seen_;
};

// The bytes of T's members: those to which a new T gives the same values, whatever was there before.
template <class T>
std::vector<bool> MemberBytes() {
  alignas(T) std::array<std::byte, sizeof(T)> first{};
  alignas(T) std::array<std::byte, sizeof(T)> second{};
  std::memset(first.data(), 0xa5, sizeof(T));
  std::memset(second.data(), 0x5a, sizeof(T));
  new (first.data()) T;
  new (second.data()) T;
  std::vector<bool> member(sizeof(T));
  for (std::size_t i = 0; i < sizeof(T); ++i) {
    member[i] = first[i] == second[i];
  }
  return member;
}

template <class T>
class FieldList : public testing::Test {};
using Structs = testing::Types<features::TargetFeature, PredictConfig, LawConfig, MoveConfig, MotionLawConfig,
                               GuardConfig, SafetyConfig>;
TYPED_TEST_SUITE(FieldList, Structs);

TYPED_TEST(FieldList, HasEveryMember) {
  TypeParam config;
  SeenBytes visitor(&config, sizeof(config));
  Fields(visitor, config);
  const std::vector<bool> member = MemberBytes<TypeParam>();
  std::size_t members = 0;
  for (std::size_t i = 0; i < sizeof(config); ++i) {
    EXPECT_TRUE(visitor.seen()[i] || !member[i])
        << "byte " << i << " of " << sizeof(config) << " is in no field";
    members += member[i] ? 1U : 0U;
  }
  EXPECT_GT(members, sizeof(config) / 2) << "padding is not distinguished from members";
}

TEST(FieldListTest, SectionsAndArmContainEveryMemberOfTheConfiguration) {
  ServoConfig config;
  SeenBytes archive(&config, sizeof(config));
  link::EachSection(config, [&](const char* /*name*/, const auto& fields) { fields(archive); });
  link::ArmFields(archive, config.arm);
  const std::vector<bool> member = MemberBytes<ServoConfig>();
  std::size_t members = 0;
  for (std::size_t i = 0; i < sizeof(config); ++i) {
    EXPECT_TRUE(archive.seen()[i] || !member[i])
        << "byte " << i << " of " << sizeof(config) << " is in no section";
    members += member[i] ? 1U : 0U;
  }
  EXPECT_GT(members, sizeof(config) / 2) << "padding is not distinguished from members";
}

// A struct with one member more than its list.
struct Short {
  double listed = 1.0;
  bool also = true;
  bool forgotten = false;
};
template <class Visitor, Struct<Short> Config>
void Fields(Visitor& v, Config& c) {
  v.Number({"a"}, c.listed, 0.0, 1.0);
  v.Flag({"b"}, c.also);
}

TEST(FieldListTest, MissingMemberIsDetected) {
  Short config;
  SeenBytes visitor(&config, sizeof(config));
  Fields(visitor, config);
  const std::vector<bool> member = MemberBytes<Short>();
  int missing = 0;
  for (std::size_t i = 0; i < sizeof(config); ++i) {
    missing += member[i] && !visitor.seen()[i] ? 1 : 0;
  }
  EXPECT_EQ(missing, 1);
}

// A visitor that puts one number of a configuration, the `target`th, out of its range.
class OutOfRange {
 public:
  explicit OutOfRange(int target) : target_(target) {}
  std::string key;  // of the field that was changed; "" past the last

  void Flag(const Field& /*field*/, bool& /*value*/) {}
  void Number(const Field& field, double& value, double min, double max) { Put(field, value, min, max); }
  void Integer(const Field& field, int& value, int min, int max) { Put(field, value, min, max); }
  template <class T, class Names>
  void Choice(const Field& /*field*/, T& /*value*/, const Names& /*names*/) {}
  void PerJoint(const Field& field, hal::JointArray& values, double min, double max) {
    Put(field, values[1], min, max);
  }
  void Count(const Field& field, int& value, int most) { Put(field, value, 0, most); }
  template <class T>
  void Derived(const Field& field, T& value, double min = 0.0, double max = 1.0) {
    if constexpr (std::is_same_v<T, double>) {
      Put(field, value, min, max);
    } else if constexpr (!std::is_same_v<T, bool>) {
      Put(field, value.data()[1], min, max);
    }
  }

 private:
  template <class T>
  void Put(const Field& field, T& value, double /*min*/, double max) {
    if (count_++ == target_) {
      key = field.key;
      value = std::is_same_v<T, int> ? static_cast<T>(max + 1.0) : static_cast<T>(std::nextafter(max, 1e300));
    }
  }

  int target_;
  int count_ = 0;
};

// Init refuses a value outside its key's range, and names the key.
TEST(FieldListTest, InitRefusesValuesOutsideTheKeysRanges) {
  task::ServoTask task;
  int refused = 0;
  for (int target = 0;; ++target) {
    ServoConfig config = test::PandaConfig();
    OutOfRange visitor(target);
    Fields(visitor, config);
    if (visitor.key.empty()) {
      break;
    }
    const hal::Status status = task.Init(config);
    EXPECT_FALSE(status.ok()) << visitor.key;
    EXPECT_EQ(status.where(), visitor.key);
    ++refused;
  }
  std::printf("%d fields\n", refused);
  EXPECT_GT(refused, 90);
}

TEST(FieldListTest, NonFiniteNumbersAreRefused) {
  for (const double value : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    PredictConfig config;
    config.gate_sigma = value;
    RangeCheck check;
    Fields(check, config);
    EXPECT_EQ(check.status().code(), hal::StatusCode::kNonFinite);
    EXPECT_STREQ(check.status().where(), "servo.gate_sigma");
  }
}

}  // namespace
}  // namespace fovea::config
