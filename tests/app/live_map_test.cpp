// SPDX-License-Identifier: MIT
#include "live/live_map.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>

#include "session/temporary_folder.h"
#include "support/as_nobody.h"
#include "support/file_text.h"
#include "thermorig/core/error.h"

namespace thermorig::app {
namespace {

namespace fs = std::filesystem;
using odometer::MapUse;
using testing::HasSubstr;

class LiveMapAtTheEnd : public session::InTemporaryFolder {
 protected:
  LiveMap opened(const std::string& name = "kitchen.map") const {
    return {path(name), CameraProfile(), true};
  }

  /// A run that ends well: what it says of its map.
  static std::string end(LiveMap&& map, const fs::path& session = "") { return end(map, session); }
  static std::string end(LiveMap& map, const fs::path& session = "") {
    RecordingHeader header;
    header.simulated = true;
    odometer::Map made;
    made.lens = odometer::Map::Lens(CameraProfile());
    made.pixel_variance_k2.fill(0.3F);
    const MapUse use = map.begun_with() ? MapUse::found : MapUse{};
    return map.write(made, use, header, session).value_or("");
  }

  void write_protect(const std::string& name) const {
    fs::permissions(path(name), fs::perms::owner_read | fs::perms::group_read | fs::perms::others_read);
  }
};

/// "code: what | where | advice" of an Error; "" where there is none.
template <typename Action>
std::string refusal_of(Action action) {
  try {
    action();
  } catch (const Error& error) {
    return std::to_string(static_cast<int>(error.code())) + ": " + error.what_happened() + " | " +
           error.where() + " | " + error.advice();
  }
  return "";
}

TEST_F(LiveMapAtTheEnd, LeavesAMapThatAppearedMeanwhileAndIsKeptBesideIt) {
  EXPECT_THAT(end(opened("other.map")), HasSubstr("other.map: written, with 0 %"));
  LiveMap map = opened();
  const std::string first = tests::file_text(path("other.map"));
  fs::rename(path("other.map"), path("kitchen.map"));
  const std::string said = end(map);
  EXPECT_THAT(said, HasSubstr("another program wrote it meanwhile, and it stays as it is"));
  EXPECT_THAT(said, HasSubstr("this run's map is in " + path("kitchen-2.map").string()));
  EXPECT_THAT(said, HasSubstr("thermorig inspect " + path("kitchen.map").string()));
  EXPECT_EQ(tests::file_text(path("kitchen.map")), first);
  EXPECT_TRUE(map_file::is_map(path("kitchen-2.map")));
}

TEST_F(LiveMapAtTheEnd, LeavesAMapThatWasReplacedMeanwhile) {
  end(opened());
  end(opened("other.map"));
  LiveMap map = opened();
  fs::rename(path("other.map"), path("kitchen.map"));
  EXPECT_THAT(end(map), HasSubstr("kitchen-2.map"));
  EXPECT_THAT(end(opened()), HasSubstr("kitchen.map: written, with")) << "a later run writes it again";
}

TEST_F(LiveMapAtTheEnd, ReadsAndReplacesTheFileBehindALinkAndTheLinkStays) {
  fs::create_directory(path("maps"));
  fs::create_symlink("maps/kitchen.map", path("link.map"));
  EXPECT_THAT(end(opened("link.map")), HasSubstr("link.map: written"));
  EXPECT_TRUE(map_file::is_map(path("maps/kitchen.map")));
  LiveMap again = opened("link.map");
  EXPECT_TRUE(again.begun_with());
  EXPECT_THAT(end(again), HasSubstr("link.map: written"));
  EXPECT_TRUE(fs::is_symlink(path("link.map")));
}

TEST_F(LiveMapAtTheEnd, NamesTheMapThatTheDiskRefusesAndHowToMakeItAgain) {
  LiveMap map = opened();
  rlimit before{};
  ::getrlimit(RLIMIT_FSIZE, &before);
  const rlimit small{1000, before.rlim_max};
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  ::setrlimit(RLIMIT_FSIZE, &small);
  const std::string kept = refusal_of([&] { end(map, "kitchen_acq-01.h5"); });
  const std::string lost = refusal_of([&] { end(map); });
  ::setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
  EXPECT_THAT(kept, testing::StartsWith("7: cannot write the map ("));
  EXPECT_THAT(kept, HasSubstr(" | " + path("kitchen.map").string() + " | free some space"));
  EXPECT_THAT(kept, HasSubstr("thermorig live --replay kitchen_acq-01.h5 --speed max --map " +
                              path("kitchen.map").string()));
  EXPECT_THAT(lost, HasSubstr("this run's map is lost; --record keeps a session"));
}

TEST_F(LiveMapAtTheEnd, IsRefusedBeforeItWhereItCouldNotBeWritten) {
  end(opened());
  write_protect("kitchen.map");
  EXPECT_THAT(refusal_of([&] { opened(); }),
              testing::StartsWith("7: cannot write the map: it is write-protected | " +
                                  path("kitchen.map").string()));
  fs::permissions(folder_, fs::perms{0555});
  EXPECT_EQ(tests::code_as_nobody([&] { opened("garden.map"); }), 7);
  fs::permissions(folder_, fs::perms::owner_all);
}

TEST_F(LiveMapAtTheEnd, IsRefusedBeforeItWhereTheOneOfBeforeMayNotBeRead) {
  end(opened());
  fs::permissions(folder_, fs::perms::all);
  fs::permissions(path("kitchen.map"), fs::perms::none);
  EXPECT_EQ(tests::code_as_nobody([&] { opened(); }), 6);
}

TEST_F(LiveMapAtTheEnd, IsRefusedBeforeItWithPlainAdviceWhereTheFileIsNoSoundMap) {
  write_file(path("kitchen.map"), {'T', 'H', 'R'});
  EXPECT_THAT(refusal_of([&] { opened(); }),
              HasSubstr("give --map the name of a file that does not exist: a new map is written there"));
}

}  // namespace
}  // namespace thermorig::app
