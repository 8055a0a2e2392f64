// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <set>

#include "thermorig/core/error.h"
#include "thermorig/rig/sweep/driven_leg.h"
#include "thermorig/rig/sweep/plan.h"

namespace thermorig::rig {

namespace {

using ::testing::HasSubstr;

template <typename Action>
std::string refusal(Action action) {
  try {
    action();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::bad_usage);
    return error.what();
  }
  return "nothing was refused";
}

TEST(SweepPlan, PaperHasFiftySpeedsInPairs) {
  const SweepPlan plan = load_plan("paper", "kitchen", 1);
  ASSERT_EQ(plan.leg_rates_dps.size(), 50U);
  std::set<double> magnitudes;
  for (std::size_t i = 0; i < 50; i += 2) {
    EXPECT_GT(plan.leg_rates_dps[i], 0.0);
    EXPECT_EQ(plan.leg_rates_dps[i], -plan.leg_rates_dps[i + 1]);
    magnitudes.insert(plan.leg_rates_dps[i]);
  }
  EXPECT_EQ(magnitudes.size(), 25U);
  EXPECT_EQ(*magnitudes.begin(), 20.0);
  EXPECT_EQ(*magnitudes.rbegin(), 200.0);
  EXPECT_EQ(*std::next(magnitudes.begin()), 27.5);
  EXPECT_EQ(plan.frames_per_leg, 57);
  EXPECT_EQ(plan.opening_rest_s, 10.0);
}

TEST(SweepPlan, SeedOrdersTheMagnitudesAndNothingElse) {
  const SweepPlan one = load_plan("paper", "kitchen", 1), same = load_plan("paper", "kitchen", 1);
  const SweepPlan two = load_plan("paper", "kitchen", 2);
  EXPECT_EQ(one.leg_rates_dps, same.leg_rates_dps);
  EXPECT_NE(one.leg_rates_dps, two.leg_rates_dps);
  EXPECT_THAT(one.leg_rates_dps, ::testing::UnorderedElementsAreArray(two.leg_rates_dps));
  EXPECT_FALSE(std::is_sorted(one.leg_rates_dps.begin(), one.leg_rates_dps.end()));
}

TEST(SweepPlan, TableOneCountsFewerFramesInTheGarden) {
  EXPECT_EQ(load_plan("table-one", "garden", 1).frames_per_leg, 51);
  for (const char* indoors : {"laboratory", "dining", "kitchen", "my-office"})
    EXPECT_EQ(load_plan("table-one", indoors, 1).frames_per_leg, 61) << indoors;
}

TEST(SweepPlan, QuickTakesAboutHalfAMinute) {
  const double duration_s = plan_duration_s(load_plan("quick", "kitchen", 1), ServoProfile{}, 7.84);
  EXPECT_GT(duration_s, 20.0);
  EXPECT_LT(duration_s, 35.0);
}

TEST(SweepPlan, OverridesReplaceWhatThePlanSays) {
  PlanOverrides overrides;
  overrides.magnitudes_dps = {50.0};
  overrides.frames_per_leg = 9;
  overrides.closing_rest_s = 0.0;
  const SweepPlan plan = load_plan("paper", "kitchen", 1, overrides);
  EXPECT_THAT(plan.leg_rates_dps, ::testing::ElementsAre(50.0, -50.0));
  EXPECT_EQ(plan.frames_per_leg, 9);
  EXPECT_EQ(plan.opening_rest_s, 10.0);
  EXPECT_EQ(plan.closing_rest_s, 0.0);
}

TEST(SweepPlan, FileGivesARangeOfSpeeds) {
  const SweepPlan plan = parse_plan(
      "name = \"mine\"\nmin_dps = 10\nmax_dps = 30\nstep_dps = 10.0\norder = \"descending\"\nboth_directions "
      "= false\n",
      "mine.toml", 1);
  EXPECT_EQ(plan.name, "mine");
  EXPECT_THAT(plan.leg_rates_dps, ::testing::ElementsAre(30.0, 20.0, 10.0));
}

TEST(SweepPlan, FileMayListMagnitudesInItsOwnOrder) {
  const SweepPlan plan =
      parse_plan("magnitudes_dps = [40, 10.5]\norder = \"given\"\nframes_per_leg = 8\n", "mine.toml", 1);
  EXPECT_THAT(plan.leg_rates_dps, ::testing::ElementsAre(40.0, -40.0, 10.5, -10.5));
  EXPECT_EQ(plan.frames_per_leg, 8);
}

TEST(SweepPlan, AsksForFiftyValidFramesALegOrWhatAShorterOneGives) {
  EXPECT_EQ(load_plan("paper", "kitchen", 1).valid_per_leg, 50);
  EXPECT_EQ(load_plan("table-one", "kitchen", 1).valid_per_leg, 50);
  EXPECT_EQ(load_plan("table-one", "garden", 1).valid_per_leg, 44);
  EXPECT_EQ(parse_plan("magnitudes_dps = [40]\nframes_per_leg = 5\n", "mine.toml", 1).valid_per_leg, 0);
  EXPECT_EQ(parse_plan("magnitudes_dps = [40]\nvalid_per_leg = 80\n", "mine.toml", 1).valid_per_leg, 80);
  PlanOverrides overrides;
  overrides.valid_per_leg = 0;
  EXPECT_EQ(load_plan("paper", "kitchen", 1, overrides).valid_per_leg, 0);
  overrides.valid_per_leg = -1;
  EXPECT_THAT(refusal([&] { load_plan("paper", "kitchen", 1, overrides); }), HasSubstr("-1 valid frames"));
  overrides.valid_per_leg = 0;
  overrides.frames_per_leg = 100'000'000;
  EXPECT_THAT(refusal([&] { load_plan("paper", "kitchen", 1, overrides); }),
              HasSubstr("100000000 frames a leg\n  try: 1 to 1000000"));
}

TEST(SweepPlan, TextGivesTheSamePlanBack) {
  const SweepPlan plan = load_plan("table-one", "garden", UINT64_MAX);
  const SweepPlan again = parse_plan(to_toml(plan), "stored", 0);
  EXPECT_EQ(again.name, plan.name);
  EXPECT_EQ(again.leg_rates_dps, plan.leg_rates_dps);
  EXPECT_EQ(again.frames_per_leg, plan.frames_per_leg);
  EXPECT_EQ(again.valid_per_leg, plan.valid_per_leg);
  EXPECT_EQ(again.opening_rest_s, plan.opening_rest_s);
  EXPECT_EQ(again.closing_rest_s, plan.closing_rest_s);
  EXPECT_EQ(again.seed, plan.seed);
}

TEST(SweepPlan, FileMistakesAreNamedWithTheirLine) {
  const auto parse = [](const std::string& text) {
    return refusal([&] { parse_plan(text, "mine.toml", 1); });
  };
  EXPECT_THAT(parse("magnitudes_dps = [40]\nframes_per_legg = 8\n"),
              HasSubstr("mine.toml:2: unknown key \"frames_per_legg\""));
  EXPECT_THAT(parse("frames_per_leg = 0\nmagnitudes_dps = [40]\n"), HasSubstr("mine.toml:1"));
  EXPECT_THAT(parse("magnitudes_dps = [40, -3]\n"), HasSubstr("-3 is out of range"));
  EXPECT_THAT(parse("magnitudes_dps = [nan]\n"), HasSubstr("out of range"));
  EXPECT_THAT(parse("magnitudes_dps = []\n"), HasSubstr("no speeds"));
  EXPECT_THAT(parse("name = \"x\"\n"), HasSubstr("no speeds"));
  EXPECT_THAT(parse("min_dps = 10\nmax_dps = 20\n"), HasSubstr("incomplete"));
  EXPECT_THAT(parse("min_dps = 20\nmax_dps = 10\nstep_dps = 1\n"), HasSubstr("it is below min_dps"));
  EXPECT_THAT(parse("magnitudes_dps = [40]\nmin_dps = 10\nmax_dps = 20\nstep_dps = 1\n"), HasSubstr("twice"));
  EXPECT_THAT(parse("leg_rates_dps = [40, 0]\n"), HasSubstr("speed 0"));
  EXPECT_THAT(parse("magnitudes_dps = [40]\n\norder = \"sideways\"\n"), HasSubstr("mine.toml:3"));
  EXPECT_THAT(parse("name = \"a\"\nmagnitudes_dps = [40\nx y\n"), HasSubstr("mine.toml:"));
}

TEST(SweepPlan, UnknownNameSaysWhatThereIs) {
  EXPECT_THAT(refusal([] { load_plan("papyrus", "kitchen", 1); }), HasSubstr("paper, quick, table-one"));
}

TEST(SweepPlan, ThatIsNestedDeepIsRefusedBeforeItIsParsed) {
  const auto parse = [](const std::string& text) {
    return refusal([&] { parse_plan(text, "mine.toml", 1); });
  };
  const std::string deep(100'000, '[');
  std::string dotted = "a";
  for (int i = 0; i < 100'000; ++i) dotted += ".a";
  std::string inlined = "a = ";
  for (int i = 0; i < 50; ++i) inlined += "{a = ";
  for (const std::string& text : {"a = " + deep, "\na = [\"]\", ']', \"\"\"]\"\"\"\", \"\\\"]\", " + deep,
                                  dotted + " = 1", "[" + dotted + "]", inlined, "a = [ # ]\n" + deep})
    EXPECT_THAT(parse(text), HasSubstr("nested more than 32 levels deep")) << text.substr(0, 40);
  EXPECT_THAT(parse("\na = " + deep), HasSubstr("mine.toml:2"));
  EXPECT_THAT(parse("name = \"" + std::string(100, '[') + "\" # " + std::string(100, '[') + "\n"),
              HasSubstr("no speeds"))
      << "texts and comments are not nested";
}

TEST(SweepPlan, TakesAListInOneLineAndNamesTheLinesOfTheFile) {
  std::string list = "1.5";
  for (int i = 1; i < 1000; ++i) list += ", 1.5";
  EXPECT_EQ(parse_plan("magnitudes_dps = [" + list + "]\n", "mine.toml", 1).leg_rates_dps.size(), 2000U);
  const auto parse = [](const std::string& text) {
    return refusal([&] { parse_plan(text, "mine.toml", 1); });
  };
  EXPECT_THAT(parse("\nmagnitudes_dps = [" + list + ", 0]\n"), HasSubstr("mine.toml:2: magnitudes_dps = 0"));
  EXPECT_THAT(parse("magnitudes_dps = [" + list + "]\nunknown = 1\n"), HasSubstr("mine.toml:2: unknown key"));
  EXPECT_THAT(parse("magnitudes_dps = [" + list + "]\nx y\n"), HasSubstr("mine.toml:2: not valid TOML"));
  EXPECT_THAT(parse("name = \"" + std::string(5000, 'x') + "\"\n"), HasSubstr("more than 4096 bytes"));
}

TEST(SweepPlan, HasNoMoreLegsThanThereAreNumbersForThem) {
  const auto parse = [](int magnitudes) {
    std::string list = "1.5";
    for (int i = 1; i < magnitudes; ++i) list += ", 1.5";
    return refusal([&] { parse_plan("magnitudes_dps = [" + list + "]\n", "mine.toml", 1); });
  };
  EXPECT_THAT(parse(32'768), HasSubstr("the plan has 65536 legs\n  try: at most 65535"));
  EXPECT_THAT(parse(65'536),
              HasSubstr("mine.toml:1: magnitudes_dps has 65536 numbers\n  try: at most 65535"));
}

TEST(SweepPlan, IsARegularFileOfAtMostAMegabyte) {
  char name[] = "/tmp/plan_test.XXXXXX";
  ASSERT_NE(::mkdtemp(name), nullptr);
  const std::filesystem::path folder = name;
  const auto load = [](const std::filesystem::path& path) {
    return refusal([&] { load_plan(path.string(), "kitchen", 1); });
  };
  ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
  EXPECT_THAT(load(folder / "pipe"), HasSubstr("a pipe or a device"));
  EXPECT_THAT(load("/dev/zero"), HasSubstr("a pipe or a device"));
  EXPECT_THAT(load(folder), HasSubstr("it is a folder"));
  std::ofstream(folder / "large.toml") << "magnitudes_dps = [40]\n" << std::string(1'000'000, '#');
  EXPECT_THAT(load(folder / "large.toml"), HasSubstr("more than the 1000000 that are read"));
  std::ofstream(folder / "small.toml") << "magnitudes_dps = [40]\n" << std::string(4000, '#');
  EXPECT_EQ(load_plan((folder / "small.toml").string(), "kitchen", 1).leg_rates_dps.size(), 2U);
  std::filesystem::remove_all(folder);
}

TEST(SweepPlan, ThatIsNoUtf8IsRefusedBeforeItIsRead) {
  for (const char* text : {"'\xCA'\xCA", "name = \"\xFF\"\n"})
    EXPECT_THAT(refusal([&] { parse_plan(text, "mine.toml", 1); }), HasSubstr("not UTF-8"));
}

TEST(PlanCheck, AcceptsTheBuiltInPlansOnTheDefaultRig) {
  for (const std::string& name : built_in_plan_names())
    EXPECT_NO_THROW(check_plan(load_plan(name, "garden", 1), ServoProfile{}, CameraProfile{})) << name;
}

TEST(PlanCheck, RefusesSpeedsBeyondTheServo) {
  SweepPlan plan = load_plan("quick", "kitchen", 1);
  plan.leg_rates_dps.push_back(-221.0);
  EXPECT_THAT(refusal([&] { check_plan(plan, ServoProfile{}, CameraProfile{}); }),
              HasSubstr("-221 deg/s is beyond"));
  ServoProfile continuous;
  continuous.kind = ServoKind::continuous;
  continuous.full_rate_dps = 100.0;
  EXPECT_THAT(refusal([&] { check_plan(load_plan("quick", "kitchen", 1), continuous, CameraProfile{}); }),
              HasSubstr("100 deg/s"));
}

TEST(PlanCheck, ShowsTheSumWhenTheLinkIsTooSlow) {
  CameraProfile camera;
  camera.link.baud = 115200;
  const std::string text =
      refusal([&] { check_plan(load_plan("quick", "kitchen", 1), ServoProfile{}, camera); });
  EXPECT_THAT(text, HasSubstr("1544 bytes x 10 bits / 115200 baud = 134.0 ms > 125.0 ms"));
  EXPECT_THAT(text, HasSubstr("7.4 frames/s"));
  camera.output_rate_hz = 4.0;
  EXPECT_NO_THROW(check_plan(load_plan("quick", "kitchen", 1), ServoProfile{}, camera));
  camera.link.baud = 1;
  EXPECT_THAT(refusal([&] { check_plan(load_plan("quick", "kitchen", 1), ServoProfile{}, camera); }),
              testing::Not(HasSubstr("at most")))
      << "no rate is slow enough";
}

/// 768 numbers take half a second at the rate that sketches print at.
TEST(PlanCheck, NamesTheSlowestUsualRateThatCarriesACamerasText) {
  CameraProfile camera;
  camera.protocol = "text";
  camera.link.baud = 115200;
  const auto text_of = [&] {
    return refusal([&] { check_plan(load_plan("quick", "kitchen", 1), ServoProfile{}, camera); });
  };
  EXPECT_THAT(text_of(),
              HasSubstr("460800 baud (set it on the camera and in the rig profile), or at most 2.1"));
  camera.link.baud = 1'000'000;
  EXPECT_EQ(text_of(), "nothing was refused");
  camera.output_rate_hz = 32.0;
  EXPECT_THAT(text_of(), HasSubstr("2000000 baud"));
  camera.output_rate_hz = 64.0;
  EXPECT_THAT(text_of(), testing::Not(HasSubstr("baud (set it")));
}

TEST(PlanCheck, RefusesLegsThatLeaveNoValidFrame) {
  SweepPlan plan = load_plan("quick", "kitchen", 1);
  plan.frames_per_leg = 3;
  const std::string text = refusal([&] { check_plan(plan, ServoProfile{}, CameraProfile{}); });
  EXPECT_THAT(text, HasSubstr("too short for any valid frame"));
  EXPECT_THAT(text, HasSubstr("3 frames at 8 Hz = 0.38 s"));
}

TEST(PlanCheck, RefusesSweepsThatLeaveNoValidFrame) {
  ServoProfile servo;
  servo.travel_deg = 90.0;
  SweepPlan plan = load_plan("quick", "kitchen", 1);
  plan.leg_rates_dps = {200.0};
  // 86 deg - 20 deg of ramps = 66 deg, 0.33 s at 200 deg/s; 0.20 s + 0.25 s are needed.
  const std::string text = refusal([&] { check_plan(plan, servo, CameraProfile{}); });
  EXPECT_THAT(text, HasSubstr("86 deg of travel, minus 20.0 deg of ramps = 0.33 s"));
  EXPECT_THAT(text, HasSubstr("= 0.45 s"));
  plan.leg_rates_dps = {100.0};
  EXPECT_NO_THROW(check_plan(plan, servo, CameraProfile{}));
}

TEST(PlanCheck, RefusesSpeedsThatCannotGiveSoManyFramesInARow) {
  ServoProfile servo;
  servo.travel_deg = 180.0;
  SweepPlan plan = load_plan("quick", "kitchen", 1);
  plan.leg_rates_dps = {200.0};
  EXPECT_NO_THROW(check_plan(plan, servo, CameraProfile{}, 3));
  // 1.075 s at 200 deg/s are 215 deg, and 20 deg of ramps.
  const std::string text = refusal([&] { check_plan(plan, servo, CameraProfile{}, 6); });
  EXPECT_THAT(text, HasSubstr("5 x 0.125 s for 6 frames in a row"));
  EXPECT_THAT(text, HasSubstr("235 deg of travel"));
  EXPECT_NO_THROW(check_plan(plan, ServoProfile{}, CameraProfile{}, 6));
}

TEST(PlanCheck, AWinchHasRoomForEveryLegOfThePaper) {
  const double limit_deg = *angle_limit_deg(ServoProfile{});
  EXPECT_EQ(limit_deg, 1078.0);
  EXPECT_LT(leg_travel_deg(200.0, 61, 7.84, 2000.0), 2.0 * limit_deg);
  EXPECT_NEAR(leg_travel_deg(-100.0, 7, 8.0, 2000.0), 100.0 * 1.15 + 2.5, 1e-9);
}

TEST(PlanDuration, CountsLegsRestsAndTransits) {
  SweepPlan plan = load_plan("paper", "kitchen", 1);
  const double duration_s = plan_duration_s(plan, ServoProfile{}, 8.0);
  EXPECT_GT(duration_s, 50 * 57 / 8.0 + 20.0);
  EXPECT_LT(duration_s, 50 * 57 / 8.0 + 20.0 + 80.0);
}

TEST(LinkLoad, IsThatOfTheDefaultRig) {
  const RigProfile profile;
  EXPECT_DOUBLE_EQ(link_load(Device::camera, profile).bytes_per_s(), 1544 * 8.0);
  EXPECT_DOUBLE_EQ(link_load(Device::gyro, profile).bytes_per_s(), 11 * 200.0);
  EXPECT_DOUBLE_EQ(link_load(Device::servo, profile).rate_hz, 100.0);
}

TEST(LinkLoad, OfATextGyroGrowsWithItsColumns) {
  RigProfile profile;
  profile.gyro.protocol = "text";
  const auto three_columns = link_load(Device::gyro, profile).message_bytes;
  EXPECT_GT(three_columns, 20U);
  profile.gyro.text.prefix = "a/g:";
  profile.gyro.text.rate = {4, 5, 6};
  EXPECT_EQ(link_load(Device::gyro, profile).message_bytes, three_columns + 4 * 8 + 4);
}

TEST(LinkLoad, OfAFlightControllerIsThatOfTheMessageItIsToSend) {
  RigProfile profile;
  profile.gyro.protocol = "mavlink";
  EXPECT_EQ(link_load(Device::gyro, profile).message_bytes, 10U + 24 + 2);
  profile.gyro.settings = {{"message", 105.0}};
  EXPECT_EQ(link_load(Device::gyro, profile).message_bytes, 10U + 63 + 2);
}

TimedFrame frame_at(double middle_s, std::uint16_t missing_before = 0) {
  TimedFrame frame;
  frame.exposure_begin = HostTime{} + from_s(middle_s - 0.1875);
  frame.exposure_end = HostTime{} + from_s(middle_s + 0.0625);
  frame.missing_before = missing_before;
  return frame;
}

double next_s(const FrameSchedule& schedule) {
  return to_s(schedule.next_middle() - HostTime{});
}

TEST(FrameSchedule, MeasuresTheRateOnceEnoughFramesHaveCome) {
  FrameSchedule schedule(8.0);
  schedule.frame(frame_at(0.0));
  EXPECT_DOUBLE_EQ(schedule.rate_hz(), 8.0);
  for (int i = 1; i < 10; ++i) schedule.frame(frame_at(0.1 * i));
  EXPECT_NEAR(schedule.rate_hz(), 10.0, 1e-6);
}

TEST(FrameSchedule, MeasuresThroughTheStepsOfALatencyTimer) {
  FrameSchedule schedule(8.0);
  for (int i = 0; i < 40; ++i) schedule.frame(frame_at(0.016 * std::ceil(0.120 * i / 0.016)));
  EXPECT_NEAR(1.0 / schedule.rate_hz(), 0.120, 0.002);
}

TEST(FrameSchedule, ALateReadDoesNotMoveTheNextFrame) {
  FrameSchedule schedule(8.0);
  for (int i = 0; i < 20; ++i) schedule.frame(frame_at(0.1 * i));
  schedule.frame(frame_at(2.0 + 0.08));
  EXPECT_NEAR(next_s(schedule), 2.1, 1e-3);
}

TEST(FrameSchedule, CountsFramesThatNeverCame) {
  FrameSchedule schedule(8.0);
  for (int i = 0; i < 20; ++i) schedule.frame(frame_at(0.1 * i));
  schedule.frame(frame_at(2.2, 2));
  EXPECT_NEAR(next_s(schedule), 2.3, 1e-3);
  EXPECT_NEAR(schedule.rate_hz(), 10.0, 1e-3);
}

TEST(FrameSchedule, TellsHowManyFramesComeOfACameraThatLosesSome) {
  FrameSchedule schedule(8.0);
  for (int i = 0; i < 300; ++i)
    if (i % 3 != 0) schedule.frame(frame_at(0.1 * i, i % 3 == 1 ? 1 : 0));
  EXPECT_NEAR(schedule.rate_hz(), 10.0, 1e-3);
  EXPECT_NEAR(schedule.arrival_rate_hz(), 20.0 / 3.0, 0.2);
}

TEST(FrameSchedule, CountsNoFramesOfACameraThatWasAway) {
  FrameSchedule schedule(8.0);
  for (int i = 0; i < 40; ++i) schedule.frame(frame_at(0.1 * i));
  schedule.frame(frame_at(9.0, 50));
  EXPECT_DOUBLE_EQ(schedule.arrival_rate_hz(), schedule.rate_hz());
}

}  // namespace

}  // namespace thermorig::rig
