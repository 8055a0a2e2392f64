// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>

#include "made_results.h"
#include "thermorig/learning/report/report.h"

namespace thermorig::tests {
namespace plots {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Key;
using ::testing::Not;
using ::testing::StartsWith;

const std::string hostile =
    "[</svg><script>alert(1)</script> 5 % & $x_1$ {\\input} ~^# 3 \u00b0 \"\xff \u03b1\u00fc";

std::map<std::string, std::string> files_of(std::vector<report::PlotFile> files) {
  std::map<std::string, std::string> by_name;
  for (report::PlotFile& file : files) EXPECT_TRUE(by_name.emplace(file.name, file.text).second) << file.name;
  return by_name;
}

/// Of one result, whose fold has a bad name: drawing takes most of the time here.
class Plots : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    if (report::draws_charts())
      files = files_of(report::study_plots(std::vector{made_result({.fold = hostile})}));
  }
  void SetUp() override {
    if (files.empty()) GTEST_SKIP() << "built without node";
  }

  inline static std::map<std::string, std::string> files;
};

TEST_F(Plots, OfAStudyAreThePapersFiguresByName) {
  for (const char* name :
       {"fig-nf.svg", "fig-nr.svg", "fig-kg.svg", "fig-angle.svg", "fig-cost.svg", "fig-speed.svg",
        "table-nf.tex", "table-nf.csv", "table-claims.tex", "captions.csv"})
    EXPECT_THAT(files, Contains(Key(name)));
  EXPECT_THAT(files.at("fig-nf.svg"),
              AllOf(StartsWith("<svg "), HasSubstr("</svg>"), HasSubstr(">thermal-only</text>"),
                    HasSubstr(">SIMULATED data</text>"), HasSubstr("<title>Box plots")));
  EXPECT_THAT(files.at("captions.csv"), HasSubstr("\nfig-nf,\"Test MSE over folds against Nf"));
}

TEST_F(Plots, HaveTablesThatLatexAndSpreadsheetsTake) {
  EXPECT_THAT(files.at("table-nf.tex"),
              AllOf(HasSubstr("\\begin{tabular}{lrrrrrrrrr}\n\\toprule\n"),
                    HasSubstr("\\multicolumn{4}{c}{paper, real data}"), HasSubstr("\\cmidrule(lr){2-5}"),
                    HasSubstr("\n3 & 0.005 & 0.005 & "), HasSubstr("SIMULATED"), HasSubstr("\\bottomrule")));
  EXPECT_THAT(files.at("table-nf.csv"), AllOf(StartsWith("Nf,\"paper, real data: median thermal-only\","),
                                              HasSubstr("\n3,0.005,0.005,")));
}

TEST_F(Plots, HoldNoMarkupOfNames) {
  for (const auto& [name, text] : files) {
    if (!name.ends_with(".svg")) continue;
    EXPECT_THAT(text, Not(HasSubstr("<script"))) << name;
    EXPECT_EQ(text.find("</svg>"), text.rfind("</svg>")) << name;
  }
  EXPECT_THAT(files.at("table-drift.tex"),
              AllOf(HasSubstr("\n{[}$<$/svg$>$$<$script"), Not(HasSubstr("\\\\\n[")),
                    HasSubstr("5 \\% \\& \\$x\\_1\\$ \\{\\textbackslash{}input\\} "
                              "\\textasciitilde{}\\^{}\\# 3 $^\\circ$ ''? ?\u00fc")));
  EXPECT_THAT(files.at("table-drift.csv"), HasSubstr("\"[</svg>"));
}

TEST_F(Plots, AreCompiledByLatex) {
  if (std::system("pdflatex --version >/dev/null 2>&1") != 0) GTEST_SKIP() << "bash app/setup.sh latex";
  std::string name = (std::filesystem::temp_directory_path() / "thermorig-latex-XXXXXX").string();
  ASSERT_NE(mkdtemp(name.data()), nullptr);
  const std::filesystem::path folder = name;
  std::ofstream document(folder / "all.tex");
  document << "\\documentclass{article}\\usepackage{booktabs}\\begin{document}\n";
  for (const auto& [file, text] : files) {
    if (!file.ends_with(".tex")) continue;
    std::ofstream(folder / file) << text;
    document << "\\input{" << file << "}\\clearpage\n";
  }
  document << "\\end{document}\n";
  document.close();
  EXPECT_EQ(std::system(("cd " + name +
                         " && pdflatex -draftmode -interaction=nonstopmode -halt-on-error all >said.txt 2>&1")
                            .c_str()),
            0)
      << std::ifstream(folder / "all.log").rdbuf();
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace plots
}  // namespace thermorig::tests
