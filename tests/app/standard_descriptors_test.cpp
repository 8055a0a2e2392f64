// SPDX-License-Identifier: MIT
// Standard input, output and errors may be closed when the program begins. What it then opens must not come
// to lie there: a journal would get what is printed, and a port would be read for standard input.
#include <array>
#include <fstream>
#include <string>

#include "program.h"

namespace thermorig::tests {
namespace {

const std::array<std::string, 7> every_choice{"<&-",      ">&-",      "2>&-",        "<&- >&-",
                                              "<&- 2>&-", ">&- 2>&-", "<&- >&- 2>&-"};

class ClosedDescriptors : public ProgramTest {
 protected:
  /// "#" ends what the shell would say about the three.
  int code_of(const std::string& arguments, const std::string& closed) const {
    return run(arguments + " >/dev/null 2>/dev/null " + closed + " #").code;
  }
};

TEST_F(ClosedDescriptors, DisturbNoCommand) {
  const std::string session = record_briefly().string();
  for (const std::string& closed : every_choice) {
    EXPECT_EQ(code_of("--version", closed), 0) << closed;
    EXPECT_EQ(code_of("inspect " + session, closed), 0) << closed;
  }
}

TEST_F(ClosedDescriptors, LeaveRecordingsAndWhatIsMadeOfThemWhole) {
  const std::string closed = "<&- >&- 2>&-";
  for (const char* seed : {"3", "4"})
    EXPECT_EQ(code_of("record --fast --environment garden --world honest --simulated=" + std::string(seed) +
                          " " + brief_plan,
                      closed),
              0);
  const auto sessions = files(".h5");
  ASSERT_EQ(sessions.size(), 2U);
  EXPECT_TRUE(files(".journal").empty());
  EXPECT_EQ(code_of("reprocess " + sessions[0].string(), "<&- >&-"), 0);
  EXPECT_EQ(code_of("inspect --check " + sessions[0].string(), "<&- >&-"), 0);
  EXPECT_EQ(code_of("live --speed max --page-port 0 --replay " + sessions[0].string(), "<&- >&-"), 0);
  EXPECT_EQ(code_of("train recordings --nf 2 --nr 3 --epochs 1 -o model.onnx", "<&- >&-"), 0);
  EXPECT_EQ(code_of("evaluate model.onnx recordings", "<&- >&-"), 0);
}

}  // namespace
}  // namespace thermorig::tests
