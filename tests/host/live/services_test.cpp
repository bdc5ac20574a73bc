// SPDX-License-Identifier: Apache-2.0
// Requests of viewers: every number is checked, and a refusal names field and range.
#include "firmware/host/live/services.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>

#include "firmware/host/live/refusal.hpp"

namespace fovea::live {
namespace {

using testing::ElementsAre;

Catalogue WithFault() {
  Catalogue catalogue;
  catalogue.faults = {{"glare", "glare in the picture", {}},
                      {"load", "a heavier load", {{"load_mass", "its mass", "kg", 0.0, 3.0, 1.0}}},
                      {"nan", "an encoder fails", {{"nan_joint", "which joint", "", 1.0, 7.0, 1.0, true}}}};
  return catalogue;
}

template <typename Wanted>
Wanted Read(Service service, std::string_view payload) {
  return std::get<Wanted>(ReadRequest(service, payload, WithFault()));
}

std::string WhyNot(Service service, std::string_view payload) {
  try {
    ReadRequest(service, payload, WithFault());
  } catch (const Refusal& refusal) {
    return refusal.what();
  }
  return "";
}

TEST(Services, RequestsAreRead) {
  Read<Hold>(Service::kHold, "");
  Read<Track>(Service::kTrack, "{}");
  EXPECT_TRUE(Read<Pause>(Service::kPause, R"({"paused":true})").paused);
  EXPECT_EQ(Read<Step>(Service::kStep, R"({"ticks":1000})").ticks, 1000);
  EXPECT_EQ(Read<Speed>(Service::kSpeed, R"({"factor":0})").factor, 0.0);
  EXPECT_EQ(Read<Speed>(Service::kSpeed, R"({"factor":0.1})").factor, 0.1);
  const Pull pull = Read<Pull>(Service::kPull, R"({"link":"hand","p_link":[0,0,0.1],"to_B":[0.5,-1,100]})");
  EXPECT_EQ(pull.link, "hand");
  EXPECT_THAT(pull.p_link, ElementsAre(0.0, 0.0, 0.1));
  EXPECT_THAT(pull.to_B, ElementsAre(0.5, -1.0, 100.0));
  EXPECT_THAT(Read<Throw>(Service::kThrow, R"({"v_BO":[1,2,3],"omega_B":[0,0,9]})").omega_B,
              ElementsAre(0.0, 0.0, 9.0));
}

TEST(Services, FaultsAreReadByTheCatalogue) {
  EXPECT_EQ(Read<StartFault>(Service::kStartFault, R"({"name":"glare"})").fault, 0U);
  const auto start =
      Read<StartFault>(Service::kStartFault, R"({"name":"load","settings":{"load_mass":2.5}})");
  EXPECT_EQ(start.fault, 1U);
  EXPECT_EQ(start.sizes, (std::map<std::string, double>{{"load_mass", 2.5}}));
  EXPECT_EQ(Read<StopFault>(Service::kStopFault, R"({"name":"load"})").fault, 1U);
  EXPECT_EQ(WhyNot(Service::kStartFault, R"({"name":"flood"})"), "there is no fault flood");
  EXPECT_EQ(WhyNot(Service::kStartFault, R"({"name":"load","settings":{"load_mass":3.5}})"),
            "load_mass must be a number from 0.0 to 3.0, got 3.5");
  EXPECT_EQ(WhyNot(Service::kStartFault, R"({"name":"load","settings":{"mass":1}})"),
            "the fault has no setting mass");
  EXPECT_EQ(Read<StartFault>(Service::kStartFault, R"({"name":"nan","settings":{"nan_joint":7.0}})").sizes,
            (std::map<std::string, double>{{"nan_joint", 7.0}}));
  EXPECT_EQ(WhyNot(Service::kStartFault, R"({"name":"nan","settings":{"nan_joint":1.5}})"),
            "nan_joint must be a whole number from 1 to 7, got 1.5");
  EXPECT_EQ(WhyNot(Service::kStartFault, R"({"name":"load","settings":[]})"), "settings must be an object");
}

TEST(Services, WrongRequestsAreRefused) {
  EXPECT_EQ(WhyNot(Service::kHold, R"({"now":true})"), "the field now is unknown");
  EXPECT_EQ(WhyNot(Service::kPause, "{}"), "the field paused is missing");
  EXPECT_EQ(WhyNot(Service::kPause, R"({"paused":1})"), "paused must be true or false");
  EXPECT_EQ(WhyNot(Service::kStep, R"({"ticks":0})"), "ticks must be a number from 1.0 to 1000.0, got 0");
  EXPECT_EQ(WhyNot(Service::kStep, R"({"ticks":1.5})"), "ticks must be a whole number");
  EXPECT_EQ(WhyNot(Service::kStep, R"({"ticks":1e300})"),
            "ticks must be a number from 1.0 to 1000.0, got 1e+300");
  EXPECT_EQ(WhyNot(Service::kSpeed, R"({"factor":0.05})"),
            "factor must be 0 (as fast as it goes), or from 0.1 to 1");
  EXPECT_EQ(WhyNot(Service::kSpeed, R"({"factor":null})"),
            "factor must be a number from 0.0 to 1.0, got null");
  EXPECT_EQ(WhyNot(Service::kPull, R"({"link":"a","p_link":[0,0],"to_B":[0,0,0]})"),
            "p_link must be a list of 3 numbers");
  EXPECT_EQ(WhyNot(Service::kPull, R"({"link":"a","p_link":[0,0,0],"to_B":[0,0,101]})"),
            "to_B must be a number from -100.0 to 100.0, got 101");
  EXPECT_EQ(WhyNot(Service::kThrow, R"({"v_BO":[21,0,0],"omega_B":[0,0,0]})"),
            "v_BO must be a number from -20.0 to 20.0, got 21");
  EXPECT_EQ(WhyNot(Service::kTrack, "track"), "the message is no valid JSON");
}

TEST(Services, TargetPosesHaveUnitQuaternions) {
  const auto hold =
      std::get<HoldTarget>(ReadTarget(kTargetPoseTopic, R"({"p_BO":[0.5,0,0.1],"q_BO":[0.995,0,0,0]})"));
  EXPECT_THAT(hold.q_BO, ElementsAre(1.0, 0.0, 0.0, 0.0));
  EXPECT_THAT(hold.p_BO, ElementsAre(0.5, 0.0, 0.1));
  EXPECT_TRUE(std::holds_alternative<ReleaseTarget>(ReadTarget(kTargetReleaseTopic, "{}")));
  for (const char* q : {"[0,0,0,0]", "[0.7,0,0,0]", "[0.8,0.8,0,0]"}) {
    EXPECT_THROW(ReadTarget(kTargetPoseTopic, std::string(R"({"p_BO":[0,0,0],"q_BO":)") + q + "}"), Refusal)
        << q;
  }
}

TEST(Services, ControlNamesAreShortAndPlain) {
  EXPECT_EQ(ReadControlName(""), "");
  EXPECT_EQ(ReadControlName(R"({"name":"Ada\n"})"), "Ada?");
  EXPECT_THROW(ReadControlName(R"({"name":7})"), Refusal);
}

TEST(Services, EachHasANameAndValidSchemas) {
  std::set<std::string> names;
  for (std::size_t i = 0; i < kNumServices; ++i) {
    const auto service = static_cast<Service>(i);
    names.insert(Name(service));
    for (const std::string& schema : {SchemasOf(service).request, SchemasOf(service).response}) {
      EXPECT_EQ(nlohmann::json::parse(schema).at("type"), "object") << Name(service);
    }
  }
  EXPECT_EQ(names.size(), kNumServices);
}

}  // namespace
}  // namespace fovea::live
