// SPDX-License-Identifier: MIT
#include "record_page.h"

#include "live/live_facts.h"
#include "live/page_address.h"

namespace thermorig::app {

RecordPage::RecordPage(const RecordOptions& options, rig::RecordingOptions& recording)
    : page_(options.page),
      run_(live_facts(LiveMode::record, options, recording), ChosenModel{},
           estimators::Bank({}, {}, recording.profile)) {
  run_.add(page_);
  tell_page(page_.server(), options.json);
  recording.wait_for_start = options.page.control;
  recording.begun = [this](const RecordingHeader& header) { run_.begun(header); };
  recording.observe = [this](const Measurement& measurement, HostTime arrived) {
    run_.add(measurement, arrived);
    return std::optional<EstimateRow>();
  };
}

}  // namespace thermorig::app
