// SPDX-License-Identifier: MIT
#include "thermorig/simulation/world.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <string>

#include "simulation/world_knobs.h"
#include "thermorig/core/error.h"

namespace thermorig::simulation {
namespace {

using testing::HasSubstr;

/// Where the value stands in the knob's range, 0 to 1.
double part_of_range(const Knob& knob, double value) {
  if (knob.scale == KnobScale::log) return std::log(value / knob.low) / std::log(knob.high / knob.low);
  return (value - knob.low) / (knob.high - knob.low);
}

TEST(WorldKnobs, HaveAnHonestValueWithinTheirRange) {
  for (const Knob& knob : world_knobs()) {
    EXPECT_GE(knob.honest(), knob.low) << knob.name;
    EXPECT_LE(knob.honest(), knob.high) << knob.name;
    EXPECT_LT(knob.low, knob.high) << knob.name;
  }
}

TEST(WorldKnobs, AreEachAPlaceOfItsOwnWithANameOfItsOwn) {
  World world;
  std::set<const double*> places;
  std::set<std::string_view> names;
  for (const Knob& knob : world_knobs()) {
    places.insert(&knob.of(world));
    names.insert(knob.name);
  }
  EXPECT_EQ(places.size(), world_knobs().size());
  EXPECT_EQ(names.size(), world_knobs().size());
  const std::size_t numbers = (sizeof(World) - sizeof(std::string)) / sizeof(double);
  EXPECT_EQ(places.size(), numbers) << "a number of a world has no knob";
}

TEST(WorldKnobs, OfALogarithmicScaleAreAboveZero) {
  for (const Knob& knob : world_knobs())
    EXPECT_TRUE(knob.scale == KnobScale::linear || knob.low > 0.0) << knob.name;
}

TEST(HonestWorldText, IsItsNameAlone) {
  EXPECT_EQ(text_of(World{}), "honest");
  EXPECT_EQ(text_of(world_named("honest", 7)), "honest");
}

TEST(TypicalWorld, DrawsEachKnobFromTheMiddleThirdOfItsRange) {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    const World world = world_named("typical", seed);
    for (const Knob& knob : world_knobs()) {
      const double value = knob.value(world);
      if (knob.comes != Comes::always && value == knob.honest()) continue;
      EXPECT_GE(part_of_range(knob, value), 1.0 / 3.0 - 1e-3) << knob.name;
      EXPECT_LE(part_of_range(knob, value), 2.0 / 3.0 + 1e-3) << knob.name;
    }
  }
}

TEST(HardWorld, DrawsEachKnobFromAllOfItsRange) {
  for (const Knob& knob : world_knobs()) {
    if (knob.comes == Comes::when_named) continue;
    double least = 1.0, most = 0.0;
    for (std::uint64_t seed = 1; seed <= 200; ++seed) {
      const double value = knob.value(world_named("hard", seed));
      if (knob.comes == Comes::by_chance && value == knob.honest()) continue;
      least = std::min(least, part_of_range(knob, value));
      most = std::max(most, part_of_range(knob, value));
    }
    EXPECT_LT(least, 0.08) << knob.name;
    EXPECT_GT(most, 0.92) << knob.name;
    EXPECT_GE(least, 0.0) << knob.name;
    EXPECT_LE(most, 1.0) << knob.name;
  }
}

/// In how many of 1000 seeds the knob is not honest.
int times_it_comes(const Knob& knob, const std::string& world) {
  int count = 0;
  for (std::uint64_t seed = 1; seed <= 1000; ++seed)
    count += knob.value(world_named(world, seed)) != knob.honest() ? 1 : 0;
  return count;
}

TEST(World, HasEffectsByChanceInOneOfTenOrInEverySecond) {
  for (const Knob& knob : world_knobs()) {
    if (knob.comes != Comes::by_chance) continue;
    EXPECT_NEAR(times_it_comes(knob, "typical"), 100, 40) << knob.name;
    EXPECT_NEAR(times_it_comes(knob, "hard"), 500, 65) << knob.name;
  }
}

TEST(World, HasNoMistakesOfItsBuilderButThoseThatAreNamed) {
  for (const Knob& knob : world_knobs()) {
    if (knob.comes != Comes::when_named) continue;
    EXPECT_EQ(times_it_comes(knob, "hard"), 0) << knob.name;
  }
  EXPECT_EQ(world_named("hard,gyro.unit=131", 1).gyro.unit, 131.0);
}

TEST(World, IsTheSameForTheSameSeedAndForNoOther) {
  EXPECT_EQ(text_of(world_named("hard", 3)), text_of(world_named("hard", 3)));
  EXPECT_NE(text_of(world_named("hard", 3)), text_of(world_named("hard", 4)));
}

TEST(World, NamesAKnobWithoutChangingAnyOther) {
  const World drawn = world_named("hard", 3);
  const World named = world_named("hard,gyro.bandwidth_hz=20,servo.damping=0.5", 3);
  EXPECT_EQ(named.gyro.bandwidth_hz, 20.0);
  EXPECT_EQ(named.servo.damping, 0.5);
  for (const Knob& knob : world_knobs()) {
    const bool is_named = knob.name == "gyro.bandwidth_hz" || knob.name == "servo.damping";
    EXPECT_TRUE(is_named || knob.value(named) == knob.value(drawn)) << knob.name;
  }
}

TEST(World, ComesBackFromItsTextWhateverTheSeed) {
  for (const char* name : {"hard", "honest,links.stall_ms=120.5,camera.tilt_deg=-2"}) {
    const World world = world_named(name, 5);
    const World again = world_named("honest" + text_of(world).substr(world.name.size()), 99);
    for (const Knob& knob : world_knobs()) EXPECT_EQ(knob.value(again), knob.value(world)) << knob.name;
  }
}

struct Refusal {
  const char* text;
  const char* what;
  const char* advice;
};

class WorldRefuses : public testing::TestWithParam<Refusal> {};

TEST_P(WorldRefuses, WithTheReasonAndWhatToTry) {
  try {
    world_named(GetParam().text, 1);
    FAIL() << "was taken";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::bad_usage);
    EXPECT_THAT(error.what_happened(), HasSubstr(GetParam().what));
    EXPECT_THAT(error.advice(), HasSubstr(GetParam().advice));
  }
}

INSTANTIATE_TEST_SUITE_P(
    Texts, WorldRefuses,
    testing::Values(Refusal{"typcal", "no world \"typcal\"", "did you mean \"typical\"? one of: typical, "},
                    Refusal{"", "no world \"\"", "one of: "},
                    Refusal{"hard,gyro.bandwith_hz=20", "no knob \"gyro.bandwith_hz\"",
                            "did you mean \"gyro.bandwidth_hz\"?"},
                    Refusal{"hard,", "no knob \"\"", "one of: "},
                    Refusal{"hard,servo.damping=2", "\"2\" is not a value of servo.damping",
                            "a number from 0.3 to 1.2"},
                    Refusal{"hard,gyro.bandwidth_hz=4.9", "\"4.9\"", "a number from 5 to 256 Hz"},
                    Refusal{"hard,servo.damping", "\"\" is not a value", "from 0.3 to 1.2"},
                    Refusal{"hard,servo.damping=0.5x", "\"0.5x\"", "from 0.3 to 1.2"},
                    Refusal{"hard,servo.damping=nan", "\"nan\"", "from 0.3 to 1.2"}));

}  // namespace
}  // namespace thermorig::simulation
