// SPDX-License-Identifier: Apache-2.0
// Specifications of wrong beliefs, their single deviations, and the search for what is borne.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "firmware/host/config/input_error.hpp"
#include "tests/support/temp_folder.hpp"
#include "tools/fovea/robustness/bars.hpp"
#include "tools/fovea/robustness/bisection.hpp"

namespace fovea::robustness {
namespace {

using nlohmann::json;
using testing::ElementsAre;
using testing::HasSubstr;

template <typename Call>
std::string ErrorOf(const Call& call) {
  try {
    call();
  } catch (const config::InputError& error) {
    return error.what();
  }
  return "";
}

TEST(RobustnessSpec, EveryFormScalesItsDifference) {
  const Spec spec = LoadSpec(
      "", {"truth.camera.mount_xyz.sigma=[0.001,0.002,0.003]", "truth.camera.latency_ms.range=[-10,20]",
           "truth.arm.load_mass.offset=0.2", "truth.camera.f_px.scale=1.02",
           "truth.arm.link_mass.scale_range=[0.9,1.3]", "truth.arm.viscous.scale_sigma=0.1"});
  EXPECT_THAT(Scaled(spec, 1.0),
              ElementsAre("truth.camera.mount_xyz.sigma=[0.001,0.002,0.003]",
                          "truth.camera.latency_ms.range=[-10,20]", "truth.arm.load_mass.offset=0.2",
                          "truth.camera.f_px.scale=1.02", "truth.arm.link_mass.scale_range=[0.9,1.3]",
                          "truth.arm.viscous.scale_sigma=0.1"));
  EXPECT_THAT(Scaled(spec, 2.0),
              ElementsAre("truth.camera.mount_xyz.sigma=[0.002,0.004,0.006]",
                          "truth.camera.latency_ms.range=[-20,40]", "truth.arm.load_mass.offset=0.4",
                          "truth.camera.f_px.scale=1.04", "truth.arm.link_mass.scale_range=[0.8,1.6]",
                          "truth.arm.viscous.scale_sigma=0.2"));
  EXPECT_TRUE(Scaled(spec, 0.0).empty());
}

TEST(RobustnessSpec, LaterAssignmentsReplaceThoseOfTheFile) {
  const test::TempFolder folder;
  const std::string file = folder.path() / "spec.toml";
  std::ofstream(file) << "[truth]\ncamera.f_px = { scale_sigma = 0.01 }\n";
  const Spec spec = LoadSpec(file, {"truth.camera.f_px.scale_sigma=0.02", "truth.arm.load_mass=0.4"});
  EXPECT_THAT(Scaled(spec, 1.0),
              ElementsAre("truth.camera.f_px.scale_sigma=0.02", "truth.arm.load_mass=0.4"));
}

TEST(RobustnessSpec, BadSpecificationsAreRefused) {
  const test::TempFolder folder;
  const std::string file = folder.path() / "spec.toml";
  const auto refusal = [&](const std::string& text) {
    std::ofstream(file) << text;
    return ErrorOf([&] { LoadSpec(file, {}); });
  };
  EXPECT_THAT(refusal("[servo]\nlambda = 3\n"), HasSubstr("spec.toml:2: servo.lambda is not allowed"));
  EXPECT_THAT(refusal("[truth]\narm.load_mass = \"much\"\n"), HasSubstr("a number or a list of numbers"));
  EXPECT_THAT(refusal(""), HasSubstr("has no key of [truth]"));
  EXPECT_THAT(ErrorOf([&] { LoadSpec(folder.path() / "none.toml", {}); }), HasSubstr("no such file"));
  EXPECT_THAT(ErrorOf([] { LoadSpec("", {}); }), HasSubstr("no uncertainty is given"));
  const Spec value = LoadSpec("", {"truth.arm.load_mass=0.4"});
  EXPECT_THAT(ErrorOf([&] { Scaled(value, 2.0); }), HasSubstr("use truth.arm.load_mass.offset"));
}

json Drawn(const char* unit, const std::vector<double>& believed) {
  return {{"unit", unit}, {"believed", believed}, {"true", believed}};
}

const json& SomeDrawn() {
  static const json kDrawn{{"camera.mount_xyz", Drawn("m", {0.05, 0.0, 0.04})},
                           {"camera.f_px", Drawn("px", {554.0})},
                           {"arm.link_mass", Drawn("kg", {4.0, 3.0, 2.0})},
                           {"arm.load_mass", Drawn("kg", {0.25})}};
  return kDrawn;
}

TEST(RobustnessBars, AxesDifferAloneAndJointsTogether) {
  const Spec spec = LoadSpec(
      "", {"truth.camera.mount_xyz.range=[-0.005,0.004]", "truth.arm.link_mass.scale_range=[0.9,1.2]",
           "truth.camera.f_px.scale_sigma=0.01", "truth.arm.load_mass.offset=0.2"});
  const std::vector<Bar> bars = BarsOf(spec, SomeDrawn());
  std::vector<std::string> low;
  std::vector<std::string> high;
  for (const Bar& bar : bars) {
    low.push_back(EndOf(bar, Side::kLow) == 0.0 ? "" : AssignmentOf(bar, Side::kLow, 1.0));
    high.push_back(AssignmentOf(bar, Side::kHigh, 2.0));
  }
  EXPECT_THAT(low, ElementsAre("truth.camera.mount_xyz.offset=[-0.005,0,0]",
                               "truth.camera.mount_xyz.offset=[0,-0.005,0]",
                               "truth.camera.mount_xyz.offset=[0,0,-0.005]", "truth.arm.link_mass.scale=0.9",
                               "truth.camera.f_px.scale=0.98", ""));
  EXPECT_THAT(high, ElementsAre("truth.camera.mount_xyz.offset=[0.008,0,0]",
                                "truth.camera.mount_xyz.offset=[0,0.008,0]",
                                "truth.camera.mount_xyz.offset=[0,0,0.008]", "truth.arm.link_mass.scale=1.4",
                                "truth.camera.f_px.scale=1.04", "truth.arm.load_mass.offset=0.4"));
  EXPECT_EQ(NameOf(bars[1]), "camera.mount_xyz y");
  EXPECT_EQ(CaseName(bars[1], Side::kHigh, 1.0), "camera.mount_xyz.y.high.1");
  EXPECT_DOUBLE_EQ(AmountOf(bars[0], Side::kLow, 2.0).number, -10.0);
  EXPECT_EQ(AmountOf(bars[0], Side::kLow, 2.0).unit, "mm");
  EXPECT_NEAR(AmountOf(bars[3], Side::kHigh, 1.0).number, 20.0, 1e-9);
  EXPECT_EQ(AmountOf(bars[3], Side::kHigh, 1.0).unit, "%");
}

TEST(RobustnessBars, WhatHasNoSingleSizeIsRefused) {
  const auto refusal = [](const std::vector<std::string>& assignments) {
    return ErrorOf([&] { BarsOf(LoadSpec("", assignments), SomeDrawn()); });
  };
  EXPECT_THAT(refusal({"truth.arm.load_mass=0.4"}), HasSubstr("use truth.arm.load_mass.offset"));
  EXPECT_THAT(refusal({"truth.arm.load_mass.offset=0.1", "truth.arm.load_mass.sigma=0.01"}),
              HasSubstr("truth.arm.load_mass has 2 forms"));
  EXPECT_THAT(refusal({"truth.arm.link_mass.scale=[1.1,1.2,1.3]"}), HasSubstr("has 3 numbers"));
  EXPECT_THAT(refusal({"truth.arm.coulomb.scale=1"}), HasSubstr("makes no difference"));
}

// For every number of borne sizes, the search finds it, in as few trials as a bisection needs.
TEST(RobustnessBisection, FindsEveryThreshold) {
  const std::size_t sizes = MarginMultiples().size();
  int most = 0;
  for (std::size_t borne = 0; borne <= sizes; ++borne) {
    Bisection search(sizes, kStatedMultiple);
    int trials = 0;
    while (const auto next = search.Next()) {
      ASSERT_LT(++trials, 20);
      search.Note(*next < borne);
    }
    EXPECT_EQ(search.borne(), borne > 0 ? std::optional(borne - 1) : std::nullopt);
    EXPECT_EQ(search.not_borne(), borne < sizes ? std::optional(borne) : std::nullopt);
    most = std::max(most, trials);
  }
  std::cout << sizes << " sizes, at most " << most << " trials\n";
  EXPECT_LE(most, 5);
}

TEST(RobustnessBisection, MultiplesGrowByTheSquareRootOfTwo) {
  const std::vector<double>& multiples = MarginMultiples();
  EXPECT_EQ(multiples.at(kStatedMultiple), 1.0);
  EXPECT_DOUBLE_EQ(multiples.front(), 0.25);
  EXPECT_DOUBLE_EQ(multiples.back(), 32.0);
  for (std::size_t i = 1; i < multiples.size(); ++i) {
    EXPECT_NEAR(multiples[i] / multiples[i - 1], std::sqrt(2.0), 1e-12);
  }
}

}  // namespace
}  // namespace fovea::robustness
