// SPDX-License-Identifier: MIT
#pragma once

#include <functional>

#include "thermorig/learning/study/study.h"

namespace thermorig::app {

/// Shows a study while it runs: on a terminal one line that is drawn over after every epoch, elsewhere a line
/// a finished job, with `json` an object a finished job.
class StudyProgress {
 public:
  explicit StudyProgress(bool json);

  /// Must not outlive this. `stop` is handed on.
  study::RunObserver observer(std::function<bool()> stop);

  /// Clears the line that is drawn over.
  void end();

 private:
  void started(const study::Progress& progress);
  void epoch_done(const study::Progress& progress);
  void job_done(const study::Progress& progress);

  bool json_;
  bool line_;
};

}  // namespace thermorig::app
