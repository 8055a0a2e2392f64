// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>

#include <fstream>
#include <sstream>

#include "program.h"
#include "thermorig/network/model/model.h"

namespace thermorig::tests {
namespace {

using ::testing::HasSubstr;

class Export : public ProgramTest {
 protected:
  Export() {
    model::Model model;
    model.weights = network::initial_weights({.frames = 2, .reduction = 3}, 1);
    model.provenance.simulated = true;
    model::write_model(folder() / "model.onnx", model);
  }

  std::string text_of(const std::string& name) const {
    std::ostringstream text;
    text << std::ifstream(folder() / name, std::ios::binary).rdbuf();
    return text.str();
  }
};

TEST_F(Export, WritesCSourcesThatCompile) {
  const Outcome outcome = run("export model.onnx --c-header --weights int8 --name garden -o board/src");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  for (const char* part : {"board/src/garden.h", "board/src/garden.c", "board/src/garden_weights.h", "flash",
                           "RAM", "SIMULATED"})
    EXPECT_THAT(outcome.out, HasSubstr(part));
  const std::string compile = "cd " + (folder() / "board/src").string() + " && cc -std=c99 -c garden.c";
  EXPECT_EQ(std::system(compile.c_str()), 0);
}

TEST_F(Export, TellsProgramsFilesAndSizes) {
  const Outcome outcome = run("export model.onnx --c-header --weights int8 --json");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const auto lines = outcome.lines();
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_EQ(lines[0]["files"].size(), 3U);
  EXPECT_EQ(lines[0]["simulated"], true);
  EXPECT_EQ(lines[0]["weights"], 89'644);
  const auto& c = lines[0]["c_header"];
  EXPECT_EQ(c["weights"], "int8");
  EXPECT_GT(c["constant_bytes"], 89'644);
  EXPECT_LT(c["constant_bytes"], 125'000);
  EXPECT_GT(c["state_bytes"], 1'000);
  if (!c["flash_bytes"].is_null()) {  // the board's compiler is there
    EXPECT_GT(c["flash_bytes"], c["constant_bytes"]);
  }
}

TEST_F(Export, FixesTheBatchOfAnOnnxFile) {
  const Outcome outcome = run("export model.onnx --batch 1 -o fixed");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const auto before = model::read_model(folder() / "model.onnx");
  const auto after = model::read_model(folder() / "fixed/model-batch1.onnx");
  EXPECT_EQ(after.weights, before.weights);
  EXPECT_NE(text_of("fixed/model-batch1.onnx"), text_of("model.onnx"));
}

TEST_F(Export, WithoutAKindSaysWhatThereIs) {
  const Outcome outcome = run("export model.onnx");
  EXPECT_EQ(outcome.code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("--c-header"));
  EXPECT_THAT(outcome.err, HasSubstr("--batch"));
  EXPECT_EQ(files(".onnx").size(), 1U);
}

TEST_F(Export, OverwritesNothing) {
  std::ofstream(folder() / "net.c") << "mine";
  const Outcome outcome = run("export model.onnx --c-header --name net");
  EXPECT_EQ(outcome.code, 7);
  EXPECT_THAT(outcome.err, HasSubstr("net.c"));
  EXPECT_EQ(text_of("net.c"), "mine");
  EXPECT_TRUE(files(".h").empty());
}

TEST_F(Export, RefusesWhatIsNoModelAndNamesThatAreNone) {
  std::ofstream(folder() / "notes.onnx") << "weights, but not ours";
  EXPECT_EQ(run("export notes.onnx --c-header").code, 8);
  EXPECT_EQ(run("export nothing.onnx --c-header").code, 2);
  EXPECT_EQ(run("export model.onnx --c-header --name 2nd").code, 2);
  EXPECT_EQ(run("export model.onnx --c-header --name '../net'").code, 2);
  EXPECT_EQ(run("export model.onnx --c-header --weights int4").code, 2);
  EXPECT_EQ(run("export model.onnx --weights int8").code, 2);
  EXPECT_EQ(run("export model.onnx --batch 0").code, 2);
  EXPECT_TRUE(files(".c").empty());
}

TEST_F(Export, RefusesFoldersThatCannotBeWrittenTo) {
  std::ofstream(folder() / "file") << "no folder";
  EXPECT_EQ(run("export model.onnx --c-header -o file/below").code, 7);
  EXPECT_EQ(run("export model.onnx --c-header -o /proc").code, 7);
}

TEST_F(Export, SaysWhatIsLeftForABoardWhereTheOdometerIsAskedFor) {
  const Outcome outcome = run("export garage.toml --odometer -o board");
  EXPECT_EQ(outcome.code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("for a board there is the network: export MODEL --c-header"));
}

TEST_F(Export, MakesFilesOfASessionBesideEachOtherAndOverwritesNone) {
  const std::string session = record_briefly().string();
  const Outcome outcome = run("export " + session + " --npz --nf 2 --csv --tum --mcap -o made/of/it --json");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const auto said = outcome.lines()[0];
  EXPECT_EQ(said["simulated"], true);
  std::string endings;
  for (const std::string file : said["files"]) {
    EXPECT_TRUE(std::filesystem::exists(folder() / file)) << file;
    endings += file.substr(file.find("Z")) + " ";
  }
  EXPECT_EQ(endings,
            "Z-nf2-nr1.npz Z-samples.csv Z-shaft.tum Z-gyro.tum Z-gyro-rest.tum Z-gyro-kalman.tum "
            "Z-odometer.tum Z-thermal-likelihood.tum Z.mcap ");
  EXPECT_TRUE(files(".part").empty());
  const Outcome again = run("export " + session + " --npz=rows --mcap -o made/of/it");
  EXPECT_EQ(again.code, 7);
  EXPECT_THAT(again.err, HasSubstr("nothing is overwritten"));
  EXPECT_EQ(files(".npz").size(), 1U);  // all or none
}

TEST_F(Export, WritesOneFormOfASessionToStandardOutput) {
  const std::string session = record_briefly().string();
  const Outcome outcome = run("export " + session + " --csv=gyro -o -");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(outcome.out.substr(0, 8), "time [s]");
  EXPECT_EQ(run("export " + session + " --tum=shaft -o -").code, 0);
  for (const char* words : {"--csv --mcap", "--tum", "--csv --json"})
    EXPECT_EQ(run("export " + session + " " + words + " -o -").code, 2) << words;
}

TEST_F(Export, RefusesWordsThatDoNotGoTogether) {
  const std::string session = record_briefly().string();
  for (const std::string& words :
       {session + " --csv=images", session + " --npz=all", session + " --tum=cnn-fusion",
        session + " --csv --nf 3", session + " --npz=rows --nr 2", session + " --npz --batch 1", session,
        std::string("missing.h5 --csv")})
    EXPECT_EQ(run("export " + words).code, 2) << words;
  EXPECT_EQ(run("export model.onnx --csv").code, 8);
  EXPECT_EQ(run("export " + session + " --batch 1").code, 8);
}

}  // namespace
}  // namespace thermorig::tests
