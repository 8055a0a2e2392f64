// SPDX-License-Identifier: MIT
#include "thermorig/learning/publication/publication.h"

#include <gmock/gmock.h>
#include <sys/stat.h>

#include <functional>

#include <nlohmann/json.hpp>

#include "../session/synthetic_session.h"
#include "../session/temporary_folder.h"
#include "../support/file_text.h"
#include "thermorig/core/error.h"
#include "thermorig/io/files/whole_file.h"

namespace thermorig::publication {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

class Publication : public session::InTemporaryFolder {
 protected:
  /// A session of its own recording.
  void write(const std::string& environment, int number, const std::string& licence = "CC-BY-4.0",
             const std::string& note = "") {
    session::Session session = session::SyntheticSession(20, static_cast<std::uint32_t>(++made_)).take();
    session.raw.header.uuid = "8d3f2a10-7f6e-4c55-9d0a-2b1c3d4e5f6" + std::to_string(made_);
    session.raw.header.environment = environment;
    session.raw.header.acquisition = number;
    session.raw.header.licence = licence;
    session.raw.header.note = note;
    const std::string name = environment + "/" + environment + "_acq-0" + std::to_string(number) + ".h5";
    std::filesystem::create_directories(path(name).parent_path());
    session::write_session(path(name), session);
  }

  std::vector<Entry> entries() const { return entries_of(folder_, true); }

  /// What `dataset build` leaves in the folder.
  void build() const {
    std::vector<Description> descriptions = describe(terms, entries());
    descriptions.push_back({sums_name, sums_text(entries(), descriptions)});
    for (const Description& description : descriptions)
      files::write_whole(path(description.name), description.text, "the description");
  }

  std::string text_of(const std::string& name, const Terms& by) const {
    for (const Description& description : describe(by, entries()))
      if (description.name == name) return description.text;
    return "";
  }

  template <typename Action>
  static ExitCode refusal(Action action) {
    try {
      action();
    } catch (const Error& error) {
      return error.code();
    }
    return ExitCode::ok;
  }

  const Terms terms{.title = "Rotations", .authors = {"A. Person"}, .date = "2026-11-23"};

 private:
  int made_ = 0;
};

TEST_F(Publication, LeavesOneEnvironmentOutAtATime) {
  write("kitchen", 1);
  write("garden", 1);
  write("garden", 2);
  const std::vector<Fold> folds = leave_one_out(entries());
  ASSERT_EQ(folds.size(), 2U);
  EXPECT_EQ(folds[0].environment, "garden");
  EXPECT_THAT(folds[0].training, ElementsAre("kitchen/kitchen_acq-01.h5"));
  EXPECT_THAT(folds[0].test, ElementsAre("garden/garden_acq-01.h5", "garden/garden_acq-02.h5"));
  EXPECT_THAT(folds[1].test, ElementsAre("kitchen/kitchen_acq-01.h5"));
}

TEST_F(Publication, LeavesNothingOutOfOneEnvironment) {
  write("kitchen", 1);
  EXPECT_TRUE(leave_one_out(entries()).empty());
}

TEST_F(Publication, NoticesEveryFileThatIsNotAsItWas) {
  write("kitchen", 1);
  write("garden", 1);
  build();
  EXPECT_TRUE(verify(folder_).empty());
  for (const char* name : {"garden/garden_acq-01.h5", "manifest.json", "DATA_CARD.md", "splits.json",
                           "CITATION.cff", "croissant.json"}) {
    const std::string before = tests::file_text(path(name));
    std::string changed = before;
    changed[changed.size() / 2] ^= 1;
    files::write_whole(path(name), changed, "the change");
    const std::vector<Difference> differences = verify(folder_);
    ASSERT_EQ(differences.size(), 1U) << name;
    EXPECT_EQ(differences[0].path, name);
    files::write_whole(path(name), before, "the change");
  }
  std::filesystem::remove(path("kitchen/kitchen_acq-01.h5"));
  write("attic", 1);
  const std::vector<Difference> differences = verify(folder_);
  ASSERT_EQ(differences.size(), 2U);
  EXPECT_EQ(differences[0].what, "is missing");
  EXPECT_EQ(differences[1].path, "attic/attic_acq-01.h5");
}

TEST_F(Publication, LooksAtNoFileOutsideOfItsFolderWhateverAListSays) {
  const std::string sum(64, 'a');
  for (const std::string& line :
       {sum + "  ../secret", sum + "  /etc/passwd", sum + "  a/../../secret", sum + " a",
        std::string("short  a"), std::string(64, 'Z') + "  a", sum + "  ",
        sum + "  a" + std::string("\0more", 5), sum + "  a\n" + sum + "  a"}) {
    files::write_whole(path(sums_name), line + "\n", "the list");
    EXPECT_EQ(refusal([&] { verify(folder_); }), ExitCode::not_a_session) << line;
  }
  std::filesystem::remove(path(sums_name));
  EXPECT_EQ(refusal([&] { verify(folder_); }), ExitCode::bad_usage);
}

/// What may stand in a folder beside or in place of a session, and what `build` and `verify` have in common.
struct Intruder {
  const char* name;
  std::function<void(const std::filesystem::path& folder)> put;
  const char* what;
};

const std::vector<Intruder>& intruders() {
  namespace fs = std::filesystem;
  const std::string session = "kitchen/kitchen_acq-01.h5";
  static const std::vector<Intruder> kinds{
      {"a second symbolic link", [=](const fs::path& in) { fs::create_symlink(in / session, in / "x.h5"); },
       "is a link"},
      {"a dangling link", [](const fs::path& in) { fs::create_symlink("nowhere", in / "x.h5"); },
       "is a link"},
      {"a loop of links", [](const fs::path& in) { fs::create_symlink("x.h5", in / "x.h5"); }, "is a link"},
      {"a link out of the folder", [](const fs::path& in) { fs::create_symlink("/etc/passwd", in / "x.h5"); },
       "is a link"},
      {"a link to a folder", [](const fs::path& in) { fs::create_directory_symlink("/etc", in / "other"); },
       "is a link"},
      {"a link to a device", [](const fs::path& in) { fs::create_symlink("/dev/zero", in / "x.h5"); },
       "is a link"},
      {"a folder", [](const fs::path& in) { fs::create_directory(in / "x.h5"); }, "is no file"},
      {"a pipe", [](const fs::path& in) { ASSERT_EQ(::mkfifo((in / "x.h5").c_str(), 0600), 0); },
       "is no file"},
      {"a second name of a session",
       [=](const fs::path& in) { fs::create_hard_link(in / session, in / "x.h5"); }, "same recording"},
      {"an empty file", [](const fs::path& in) { files::write_whole(in / "x.h5", "", "the file"); },
       "is empty"}};
  return kinds;
}

TEST_F(Publication, IsNotBuiltOfWhatWouldNotBeVerified) {
  write("kitchen", 1);
  build();
  for (const Intruder& intruder : intruders()) {
    intruder.put(folder_);
    EXPECT_THAT(verify(folder_), testing::SizeIs(1)) << intruder.name;
    try {
      entries();
      ADD_FAILURE() << intruder.name;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ExitCode::not_a_session) << intruder.name;
      EXPECT_THAT(error.what_happened(), HasSubstr(intruder.what)) << intruder.name;
    }
    for (const char* name : {"x.h5", "other"}) std::filesystem::remove(path(name));
    EXPECT_TRUE(verify(folder_).empty()) << intruder.name;
  }
}

TEST_F(Publication, IsNotVerifiedWhereALineIsMissingOrOneIsTooMany) {
  write("kitchen", 1);
  build();
  const std::string whole = tests::file_text(path(sums_name));
  for (const char* name : {"kitchen/kitchen_acq-01.h5", "manifest.json", "DATA_CARD.md", "splits.json",
                           "CITATION.cff", "croissant.json"}) {
    const std::size_t at = whole.find(std::string("  ") + name) - 64;
    std::string less = whole;
    less.erase(at, whole.find('\n', at) + 1 - at);
    files::write_whole(path(sums_name), less, "the list");
    const std::vector<Difference> differences = verify(folder_);
    ASSERT_EQ(differences.size(), 1U) << name;
    EXPECT_EQ(differences[0].path, name);
  }
  files::write_whole(path("more.txt"), "", "the file");
  const std::string sum_of_nothing = "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855";
  files::write_whole(path(sums_name), whole + sum_of_nothing + "  more.txt\n", "the list");
  EXPECT_THAT(verify(folder_), testing::SizeIs(1));
}

TEST_F(Publication, ReadsOnlyFilesAndFollowsNoLinkWhateverTheListIs) {
  namespace fs = std::filesystem;
  write("kitchen", 1);
  build();
  const std::string sums = tests::file_text(path(sums_name));
  fs::rename(path("kitchen"), path("moved"));
  fs::create_directory_symlink("moved", path("kitchen"));
  EXPECT_FALSE(verify(folder_).empty()) << "the way to a session leads over a link";
  fs::remove(path("kitchen"));
  fs::rename(path("moved"), path("kitchen"));

  fs::rename(path("manifest.json"), path("elsewhere"));
  fs::create_symlink("elsewhere", path("manifest.json"));
  ASSERT_EQ(verify(folder_).size(), 1U);
  EXPECT_THAT(verify(folder_)[0].what, HasSubstr("is a link"));
  fs::remove(path("manifest.json"));
  fs::rename(path("elsewhere"), path("manifest.json"));

  const std::vector<std::function<void()>> lists{
      [&] { ASSERT_EQ(::mkfifo(path(sums_name).c_str(), 0600), 0); },
      [&] { fs::create_symlink("/etc/passwd", path(sums_name)); },
      [&] { fs::create_symlink("/dev/zero", path(sums_name)); },
      [&] { fs::create_directory(path(sums_name)); },
      [&] {
        files::write_whole(path(sums_name), "", "the list"), fs::resize_file(path(sums_name), 65U << 20U);
      }};
  for (const auto& put : lists) {
    fs::remove(path(sums_name));
    put();
    EXPECT_EQ(refusal([&] { verify(folder_); }), ExitCode::not_a_session);
  }
}

TEST_F(Publication, HasTheSumOfTheBytesThatItsFactsAreOf) {
  write("kitchen", 1);
  const std::string file = path("kitchen/kitchen_acq-01.h5").string(), before = tests::file_text(file);
  write("kitchen", 2);
  const std::string other = tests::file_text(path("kitchen/kitchen_acq-02.h5"));
  // Another program replaces the first one as soon as it has been read.
  std::size_t read = 0;
  const std::vector<Entry> built = entries_of(folder_, true, [&](std::size_t, std::size_t) {
    if (++read == 1) files::write_whole(file, other, "the file");
  });
  files::write_whole(file, before, "the file");
  EXPECT_EQ(built[0].session.header.uuid, entries()[0].session.header.uuid);
  EXPECT_EQ(built[0].sha256, entries()[0].sha256);
}

TEST_F(Publication, RefusesNamesThatItsDescriptionsCannotHold) {
  for (const char* name : {"x\xff.h5", "x\ny.h5", "x\\y.h5", "x\xc3.h5"}) {
    write("kitchen", 1);
    std::filesystem::rename(path("kitchen/kitchen_acq-01.h5"), path("kitchen") / name);
    EXPECT_EQ(refusal([&] { entries(); }), ExitCode::bad_usage) << name;
    std::filesystem::remove(path("kitchen") / name);
  }
  write("kitchen", 1);
  std::filesystem::rename(path("kitchen/kitchen_acq-01.h5"), path("kitchen/k\u00fcche.h5"));
  EXPECT_EQ(entries()[0].path, "kitchen/k\u00fcche.h5");
}

TEST_F(Publication, NamesAuthorsOfAnyScriptInTheCitation) {
  write("kitchen", 1);
  Terms odd = terms;
  odd.authors = {"J\u00f6rg \U0001F600", "\u7530\u4e2d", "a \u0085 b\u202e \x7f \\ \""};
  const std::string citation = text_of("CITATION.cff", odd);
  EXPECT_THAT(citation, HasSubstr("- name: \"J\u00f6rg \U0001F600\"\n"));
  EXPECT_THAT(citation, HasSubstr("- name: \"\u7530\u4e2d\"\n"));
  EXPECT_THAT(citation, HasSubstr(R"(- name: "a \U00000085 b\U0000202E \U0000007F \\ \"")"));
}

TEST_F(Publication, TakesNoRecordingTwiceAndNothingThatIsNone) {
  write("kitchen", 1);
  std::filesystem::copy_file(path("kitchen/kitchen_acq-01.h5"), path("kitchen/copy.h5"));
  EXPECT_EQ(refusal([&] { entries(); }), ExitCode::not_a_session);
  files::write_whole(path("kitchen/copy.h5"), "no session", "the file");
  EXPECT_EQ(refusal([&] { entries(); }), ExitCode::not_a_session);
}

TEST_F(Publication, TakesABadSessionOnlyIfThatIsAskedForAndSaysSo) {
  write("kitchen", 1);  // a synthetic one has times that nobody knows
  ASSERT_EQ(entries()[0].session.quality.verdict, "bad");
  EXPECT_EQ(refusal([&] { entries_of(folder_, false); }), ExitCode::check_failed);
  EXPECT_THAT(text_of("DATA_CARD.md", terms), HasSubstr("acq-01.h5: bad: "));
}

TEST_F(Publication, StatesTheLicenceOfTheSessionsOnlyIfTheyAgree) {
  write("kitchen", 1);
  write("garden", 1);
  EXPECT_EQ(licence_of(terms, entries()), "CC-BY-4.0");
  write("attic", 1, "");
  EXPECT_EQ(licence_of(terms, entries()), "");
  EXPECT_THAT(text_of("DATA_CARD.md", terms), HasSubstr("No licence is stated"));
  Terms stated = terms;
  stated.licence = "CC0-1.0";
  EXPECT_THAT(text_of("CITATION.cff", stated), HasSubstr("license: \"CC0-1.0\""));
}

TEST_F(Publication, ShowsTextOfSessionsAsTextAndNotAsMarkdown) {
  write("kitchen", 1, "CC-BY-4.0", "<script>alert(1)</script> | [a](http://b)");
  const std::string card = text_of("DATA_CARD.md", terms);
  EXPECT_THAT(card, HasSubstr("\\<script\\>alert(1)\\</script\\> \\| \\[a\\](http://b)"));
  EXPECT_THAT(card, Not(HasSubstr("<script>")));
  Terms odd = terms;
  odd.title = "a \"title\": of\ntwo lines";
  EXPECT_THAT(text_of("CITATION.cff", odd),
              HasSubstr("title: \"a \\\"title\\\": of\\U0000000Atwo lines\"\n"));
}

TEST_F(Publication, NamesEverySessionWithItsSumToOtherPrograms) {
  write("kitchen", 1);
  write("garden", 1);
  const auto croissant = nlohmann::json::parse(text_of("croissant.json", terms));
  for (const char* key : {"@context", "@type", "name", "description", "conformsTo", "license", "version",
                          "datePublished", "citeAs", "creator", "distribution", "recordSet"})
    EXPECT_TRUE(croissant.contains(key)) << key;
  EXPECT_EQ(croissant["conformsTo"], "http://mlcommons.org/croissant/1.0");
  const auto manifest = nlohmann::json::parse(text_of("manifest.json", terms));
  const std::vector<Entry> sessions = entries();
  ASSERT_EQ(croissant["distribution"].size(), 3U);
  for (std::size_t i = 0; i < 2; ++i) {
    const auto& file = croissant["distribution"][i + 1];
    EXPECT_EQ(file["@type"], "cr:FileObject");
    EXPECT_EQ(file["contentUrl"], sessions[i].path);
    EXPECT_EQ(file["sha256"], sessions[i].sha256);
    EXPECT_EQ(manifest["sessions"][i]["sha256"], sessions[i].sha256);
  }
  for (const auto& field : croissant["recordSet"][0]["field"]) {  // every field is one of the manifest
    const std::string column = field["source"]["extract"]["jsonPath"];
    EXPECT_TRUE(manifest["sessions"][0].contains(column.substr(column.rfind('.') + 1))) << column;
    EXPECT_EQ(field["source"]["fileObject"]["@id"], croissant["distribution"][0]["@id"]);
  }
}

TEST_F(Publication, SaysWhatIsSimulated) {
  write("kitchen", 1);
  EXPECT_THAT(text_of("DATA_CARD.md", terms), HasSubstr("**All recordings are SIMULATED.**"));
  EXPECT_THAT(text_of("CITATION.cff", terms), HasSubstr("of a SIMULATED rig"));
  EXPECT_EQ(nlohmann::json::parse(text_of("manifest.json", terms))["simulated_sessions"], 1);
}

}  // namespace
}  // namespace thermorig::publication
