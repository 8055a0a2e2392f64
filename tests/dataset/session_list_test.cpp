// SPDX-License-Identifier: MIT
#include "thermorig/learning/dataset/session_list.h"

#include <gtest/gtest.h>

#include "../session/synthetic_session.h"
#include "../session/temporary_folder.h"

namespace thermorig::dataset {
namespace {

using SessionList = session::InTemporaryFolder;

TEST_F(SessionList, HasTheOperatorsMarksAsNotesAndWhyAFileIsNoSession) {
  session::Session session = session::SyntheticSession(20, 1).take();
  session.raw.events.push_back(
      {.time = session.raw.header.time_reference, .kind = EventKind::mark, .message = "the door opened"});
  session::write_session(path("a.h5"), session);
  write_file(path("b.h5"), std::vector<char>(100, 'x'));
  std::size_t told = 0;
  const auto list = list_sessions({path("b.h5"), path("a.h5")}, [&](std::size_t, std::size_t) { ++told; });
  ASSERT_EQ(list.size(), 2U);
  ASSERT_TRUE(list[0].refusal);
  EXPECT_EQ(list[0].refusal->code(), ExitCode::not_a_session);
  EXPECT_EQ(list[0].file, path("b.h5"));
  EXPECT_FALSE(list[1].refusal);
  EXPECT_EQ(list[1].header.uuid, session.raw.header.uuid);
  EXPECT_EQ(list[1].quality.verdict, session::quality_of(session).verdict);
  EXPECT_EQ(list[1].notes.back(), "the door opened");
  EXPECT_EQ(told, 2U);
}

TEST(World, IsWhatTheSimulationEndsWith) {
  RecordingHeader header;
  header.simulated = true;
  header.simulation = "ports, AVR image, servo 270, world hard,gyro.bandwidth_hz=20,camera.roll_deg=1";
  EXPECT_EQ(world_of(header), "hard,gyro.bandwidth_hz=20,camera.roll_deg=1");
  header.simulation = "virtual time, firmware's host build";
  EXPECT_EQ(world_of(header), "");
  header.simulation = "told by a real rig, world hard";
  header.simulated = false;
  EXPECT_EQ(world_of(header), "");
}

}  // namespace
}  // namespace thermorig::dataset
