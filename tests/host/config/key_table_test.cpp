// SPDX-License-Identifier: Apache-2.0
// Keys: valid settings are applied as a whole. An error names the
// file, the line and the allowed values, and changes nothing.
#include "firmware/host/config/key_table.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <fstream>

#include "firmware/host/config/input_error.hpp"
#include "tests/support/temp_folder.hpp"

namespace fovea::config {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class KeyTableTest : public testing::Test {
 protected:
  KeyTableTest() {
    keys_.Number("camera.rate_hz", rate_, 1.0, 240.0, "Hz", "frames per second");
    keys_.Integer("run.seed", seed_, 0, 100, "", "seed of the random numbers");
    keys_.Flag("servo.predict", predict_, "predict");
    keys_.Text("arm.model", model_, "which arm");
    keys_.Choice("target.motion", motion_, {"still", "circle"}, "how it moves");
    keys_.Numbers("target.position", position_, 3, 3, -5.0, 5.0, "m", "where it is");
  }
  std::string ErrorOf(const std::string& assignment) {
    try {
      keys_.Apply(ParseAssignment(assignment));
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  }

  double rate_ = 30.0;
  int seed_ = 1;
  bool predict_ = true;
  std::string model_ = "panda";
  std::string motion_ = "still";
  std::vector<double> position_{0.0, 0.0, 0.0};
  KeyTable keys_;
};

TEST_F(KeyTableTest, SetsEveryKindOfValue) {
  for (const char* assignment : {"camera.rate_hz=60", "run.seed=7", "servo.predict=false", "arm.model=ur5e",
                                 "target.motion=\"circle\"", "target.position=[1, 2.5, -3]"}) {
    EXPECT_EQ(ErrorOf(assignment), "accepted");
  }
  EXPECT_EQ(rate_, 60.0);
  EXPECT_EQ(seed_, 7);
  EXPECT_FALSE(predict_);
  EXPECT_EQ(model_, "ur5e");
  EXPECT_EQ(motion_, "circle");
  EXPECT_THAT(position_, ElementsAre(1.0, 2.5, -3.0));
}

TEST_F(KeyTableTest, RefusesABadValueAndNamesWhatIsAllowed) {
  struct Case {
    const char* assignment;
    const char* words;
  };
  for (const Case& c :
       {Case{"camera.rate_hz=-3", "1 to 240 Hz"}, Case{"camera.rate_hz=nan", "a number"},
        Case{"camera.rate_hz=inf", "1 to 240 Hz"}, Case{"camera.rate_hz=true", "a number"},
        Case{"camera.rate_hz=[3]", "a number"}, Case{"run.seed=1.5", "a whole number"},
        Case{"run.seed=101", "0 to 100"}, Case{"servo.predict=1", "true or false"},
        Case{"arm.model=3", "a text"}, Case{"target.motion=spin", "\"still\", \"circle\""},
        Case{"target.position=[1, 2]", "3 numbers"}, Case{"target.position=[1, 2, 9]", "-5 to 5 m"},
        Case{"target.position=[1, 2, \"x\"]", "must be a number"},
        Case{"target.position={a = 1}", "a table is not allowed"},
        Case{"camera.rate_hz=3\nfoo=1", "more than one value"}}) {
    EXPECT_THAT(ErrorOf(c.assignment), HasSubstr(c.words));
  }
  EXPECT_EQ(rate_, 30.0) << "nothing was changed";
  EXPECT_EQ(seed_, 1);
  EXPECT_THAT(position_, ElementsAre(0.0, 0.0, 0.0));
}

TEST_F(KeyTableTest, UnknownKeySuggestsTheNearestKnownOne) {
  EXPECT_THAT(ErrorOf("camera.rate=30"), HasSubstr("did you mean camera.rate_hz?"));
  EXPECT_THAT(ErrorOf("servo.predikt=true"), HasSubstr("did you mean servo.predict?"));
  EXPECT_THAT(ErrorOf("zzz=1"), testing::Not(HasSubstr("did you mean")));
}

TEST(DidYouMeanTest, IsTheEndOfASentenceOrNothing) {
  const std::vector<std::string> names{"panda", "ur5e"};
  EXPECT_EQ(DidYouMean("pandda", names), "; did you mean panda?");
  EXPECT_EQ(DidYouMean("ur5", names), "; did you mean ur5e?");
  EXPECT_EQ(DidYouMean("quite-another", names), "");
  EXPECT_EQ(DidYouMean("panda", {}), "");
}

TEST_F(KeyTableTest, RenamedKeyNamesItsSuccessorAndSetsNothing) {
  keys_.Renamed("camera.frequency_hz", "camera.rate_hz");
  EXPECT_THAT(ErrorOf("camera.frequency_hz=60"),
              HasSubstr("the key camera.frequency_hz is called camera.rate_hz now"));
  EXPECT_EQ(keys_.NameToday("camera.frequency_hz"), "camera.rate_hz");
  EXPECT_EQ(keys_.NameToday("camera.rate_hz"), "camera.rate_hz");
}

TEST_F(KeyTableTest, MalformedAssignmentIsRefused) {
  for (const char* text : {"", "=3", "servo.predict", "arm.model=", "arm.model=\"open", "a=[1,"}) {
    EXPECT_THAT(ErrorOf(text), testing::StartsWith("--set")) << text;
  }
}

// A refusal is one line, and quoted text cannot send control characters to the terminal.
TEST_F(KeyTableTest, ControlCharactersInErrorsAreEscaped) {
  for (const char* text : {"servo\n.predict", "\x1b[2J=1\r\n", "arm.model=\x7f\""}) {
    const std::string error = ErrorOf(text);
    EXPECT_THAT(error, testing::StartsWith("--set"));
    EXPECT_TRUE(std::none_of(error.begin(), error.end(), [](unsigned char c) {
      return std::iscntrl(c) != 0;
    })) << error;
  }
}

TEST_F(KeyTableTest, DefaultsAndRangesComeFromTheFields) {
  EXPECT_EQ(keys_.keys()[0].default_text, "30");
  EXPECT_EQ(keys_.keys()[0].allowed, "1 to 240");
  EXPECT_EQ(keys_.keys()[5].default_text, "[0, 0, 0]");
}

TEST(TomlFileTest, ErrorsNameFileAndLine) {
  const test::TempFolder folder;
  const auto file = folder.path() / "scenario.toml";
  const auto error = [&](const std::string& toml) -> std::string {
    std::ofstream(file) << toml;
    try {
      ReadTomlFile(file);
    } catch (const InputError& e) {
      return e.what();
    }
    return "accepted";
  };
  EXPECT_THAT(error("[run]\nseed = = 3\n"), HasSubstr("scenario.toml:2: not TOML"));
  EXPECT_THAT(error("[run]\nday = 2020-01-01\n"), HasSubstr("scenario.toml:2: run.day"));
  EXPECT_THAT(error("a = [1, [2]]\n"), HasSubstr("scenario.toml:1"));
  EXPECT_EQ(error(""), "accepted");
  EXPECT_EQ(error("[run]\n"), "accepted");
  EXPECT_THAT(error("[truth]\ncamera.latency_ms = {}\n"),
              HasSubstr("scenario.toml:2: truth.camera.latency_ms is an empty table"));
  EXPECT_THAT(error("[truth.camera.latency_ms]\n"), HasSubstr("scenario.toml:1: truth.camera.latency_ms is"));
  EXPECT_THROW(ReadTomlFile(folder.path() / "none.toml"), InputError);
  EXPECT_THROW(ReadTomlFile(folder.path()), InputError);

  std::ofstream(file) << "[camera]\nrate_hz = 60\n[camera.lens]\nf = 1.5\n";
  const auto settings = ReadTomlFile(file);
  ASSERT_EQ(settings.size(), 2U);
  EXPECT_EQ(settings[0].key, "camera.lens.f");
  EXPECT_EQ(settings[1].key, "camera.rate_hz");
  EXPECT_THAT(settings[1].where, HasSubstr("scenario.toml:2"));
}

TEST(ParseAssignmentTest, ATableIsToBeGivenKeyByKey) {
  try {
    static_cast<void>(ParseAssignment("truth.camera.latency_ms={sigma=1}"));
    FAIL() << "accepted";
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(),
                 "--set truth.camera.latency_ms: a table is not allowed here; give each of its keys, as in "
                 "--set truth.camera.latency_ms.NAME=VALUE");
  }
}

// The parser would accept such a key, but would recurse as deeply as it is nested.
TEST(ReadTomlFile, LineThatIsTooLongIsRefused) {
  const test::TempFolder folder;
  const std::filesystem::path file = folder.path() / "deep.toml";
  std::string key = "a";
  for (int k = 0; k < 40'000; ++k) {
    key += ".a";
  }
  for (const std::string& line : {key + " = 1", "[" + key + "]"}) {
    std::ofstream(file) << "[camera]\n" << line << "\n";
    try {
      ReadTomlFile(file);
      ADD_FAILURE() << "accepted";
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr("deep.toml:2: a line of 8000"));
      EXPECT_THAT(error.what(), HasSubstr("at most 10000 are allowed"));
    }
  }
  EXPECT_THROW(ParseAssignment("x={" + key + "=1}"), InputError);
}

}  // namespace
}  // namespace fovea::config
