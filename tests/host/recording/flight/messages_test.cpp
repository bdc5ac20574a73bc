// SPDX-License-Identifier: Apache-2.0
// The servo's configuration in a log: every field is read
// back, and a field that an older log lacks gets its default.
#include "firmware/host/recording/flight/messages.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "firmware/host/recording/flight/message_difference.hpp"
#include "fovea/tick.pb.h"
#include "tests/support/panda.hpp"

namespace fovea::flight {
namespace {

config::ServoConfig SomeConfig() {
  config::ServoConfig config = test::PandaConfig();
  config.law.lambda = 1.0 / 3.0;
  config.law.unreachable_progress = 0.07;
  config.guard.obstacles.num_planes = 2;
  config.safety.carried_torque_fraction = 0.0;
  config.safety.contact_sudden_fraction = 0.3;
  config.load.offset = 0.3;
  config.arm.joints[6].spring = 4.5;
  config.arm.joints[6].rotor_inertia = 0.2;
  return config;
}

TEST(ServoConfigurationTest, RoundTripKeepsEveryField) {
  const log::ServoConfiguration message = ToMessage(SomeConfig());
  EXPECT_EQ(message.sections_size(), 11);
  const config::ServoConfig back = FromMessage(message);
  EXPECT_EQ(ToMessage(back).SerializeAsString(), message.SerializeAsString());
  EXPECT_EQ(back.law.lambda, 1.0 / 3.0);
  EXPECT_EQ(back.load.offset, 0.3);
  EXPECT_EQ(back.arm.joints[6].spring, 4.5);
  EXPECT_EQ(back.arm.joints[6].rotor_inertia, 0.2);
}

TEST(ServoConfigurationTest, FieldMissingFromALogTakesItsDefault) {
  log::ServoConfiguration message = ToMessage(SomeConfig());
  for (auto& section : *message.mutable_sections()) {
    std::string& fields = *section.mutable_fields();
    if (section.name() == "law") {
      fields.resize(fields.size() - sizeof(double) - sizeof(bool));
    } else if (section.name() == "safety") {
      fields.resize(fields.size() - sizeof(double));
    } else if (section.name() == "arm") {
      fields.resize(fields.size() - model::kMaxJoints * sizeof(double));
    }
  }
  const config::ServoConfig back = FromMessage(message);
  EXPECT_EQ(back.arm.joints[6].spring, 4.5);
  EXPECT_EQ(back.arm.joints[6].rotor_inertia, 0.0);
  EXPECT_EQ(back.law.plans, config::LawConfig{}.plans);
  EXPECT_EQ(back.law.unreachable_progress, config::LawConfig{}.unreachable_progress);
  EXPECT_EQ(back.safety.contact_sudden_fraction, config::SafetyConfig{}.contact_sudden_fraction);
  EXPECT_EQ(back.safety.carried_torque_fraction, 0.0);
  EXPECT_EQ(back.law.lambda, 1.0 / 3.0);
}

// Before format 3, clearances counted from the lines between the joints.
TEST(ServoConfigurationTest, ClearancesOfAnOlderLogCountFromTheLinksSurface) {
  config::ServoConfig old = SomeConfig();
  ASSERT_EQ(old.arm.num_joints, 7);
  for (model::Capsule& body : old.arm.shape.bodies) {
    body.radius = 0.02;
  }
  old.arm.shape.bodies[1].radius = 0.05;  // near the base: used for lines of sight, not for planes
  old.arm.shape.bodies[5].radius = 0.04;  // used for planes, not for lines of sight
  const auto read = [&old](double planes, double sight, bool in_older_log) {
    old.guard.link_clearance = planes;
    old.guard.sight_clearance = sight;
    log::ServoConfiguration message = ToMessage(old);
    if (in_older_log) {
      message.clear_format();
    }
    return FromMessage(message).guard;
  };
  EXPECT_DOUBLE_EQ(read(0.06, 0.08, true).link_clearance, 0.02);
  EXPECT_DOUBLE_EQ(read(0.06, 0.08, true).sight_clearance, 0.03);
  EXPECT_EQ(read(0.03, 0.03, true).link_clearance, 0.0);
  EXPECT_EQ(read(0.03, 0.03, true).sight_clearance, 1e-3) << "0 would switch the limit off";
  EXPECT_EQ(read(0.03, 0.0, true).sight_clearance, 0.0) << "the limit was off";
  EXPECT_EQ(read(0.06, 0.08, false).link_clearance, 0.06);
  EXPECT_EQ(read(0.06, 0.08, false).sight_clearance, 0.08);
}

TEST(ServoConfigurationTest, UnknownOrTruncatedFieldsAreRefused) {
  log::ServoConfiguration later = ToMessage(SomeConfig());
  later.mutable_sections(4)->mutable_fields()->append(8, '\0');
  EXPECT_THROW(FromMessage(later), std::runtime_error);
  log::ServoConfiguration strange = ToMessage(SomeConfig());
  strange.mutable_sections(4)->set_name("manners");
  EXPECT_THROW(FromMessage(strange), std::runtime_error);
  log::ServoConfiguration cut = ToMessage(SomeConfig());
  cut.mutable_sections(4)->mutable_fields()->resize(9);  // within a field
  EXPECT_THROW(FromMessage(cut), std::runtime_error);
}

TEST(MessageDifferenceTest, NamesEveryFieldThatDiffersInABit) {
  log::Tick a;
  a.set_tick(3);
  a.mutable_command()->add_tau(0.0);
  a.mutable_command()->add_tau(2.0);
  a.add_s(1.0);
  a.set_mode(log::HOLD);
  log::Tick b = a;
  const auto differences = [&] {
    std::vector<std::string> lines;
    EachDifference(a, b, [&](const FieldDifference& d) {
      lines.push_back(d.field + ": " + d.a + " -> " + d.b + " by " + std::to_string(d.size));
    });
    return lines;
  };
  EXPECT_THAT(differences(), testing::IsEmpty());
  b.mutable_command()->set_tau(0, -0.0);
  b.mutable_command()->set_tau(1, 2.5);
  b.set_mode(log::TRACK);
  b.add_s(2.0);
  b.mutable_arm()->set_sequence(7);
  EXPECT_THAT(differences(),
              testing::ElementsAre("arm.sequence: 0 -> 7 by 7.000000", "mode: HOLD -> TRACK by inf",
                                   "s: 1 entries -> 2 entries by inf", "command.tau[0]: 0 -> -0 by 0.000000",
                                   "command.tau[1]: 2 -> 2.5 by 0.500000"));
}

}  // namespace
}  // namespace fovea::flight
