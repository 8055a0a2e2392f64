// SPDX-License-Identifier: MIT
#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

namespace thermorig::tests {

/// The ledger of void runs for as long as it lives.
class TemporaryLedger {
 public:
  TemporaryLedger() {
    if (const char* before = std::getenv("THERMORIG_LEDGER")) before_ = before;
    std::string name = (std::filesystem::temp_directory_path() / "ledger-XXXXXX").string();
    folder_ = mkdtemp(name.data());
    setenv("THERMORIG_LEDGER", path().c_str(), 1);
  }
  ~TemporaryLedger() {
    std::filesystem::remove_all(folder_);
    setenv("THERMORIG_LEDGER", before_.c_str(), 1);
  }
  TemporaryLedger(const TemporaryLedger&) = delete;
  TemporaryLedger& operator=(const TemporaryLedger&) = delete;

  std::string text() const {
    std::ifstream file(path());
    return {std::istreambuf_iterator<char>(file), {}};
  }
  void note_that_the_suite_has_waited() const { std::ofstream(path() + ".waited"); }

 private:
  std::string path() const { return folder_ / "void_runs.txt"; }

  std::filesystem::path folder_;
  std::string before_;
};

}  // namespace thermorig::tests
