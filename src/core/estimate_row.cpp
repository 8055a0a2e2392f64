// SPDX-License-Identifier: MIT
#include "thermorig/core/estimate_row.h"

namespace thermorig {

std::vector<EstimatorColumn> columns_before_format_2(const LiveModel& model) {
  std::vector<EstimatorColumn> columns{{.name = "gyro", .values = {}}};
  if (!model.name.empty()) columns.push_back({.name = "cnn-thermal", .values = {}});
  if (model.fusion) columns.push_back({.name = "cnn-fusion", .values = {"gain"}});
  return columns;
}

}  // namespace thermorig
