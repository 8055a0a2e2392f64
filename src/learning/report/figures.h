// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <string>

#include "document.h"

namespace thermorig::report {

/// Draws charts as SVG by charts/figure.js, in an engine of its own that reaches nothing else.
class FigureDrawer {
 public:
  /// Takes a third of a second. Throws Error(failed) if this program was built without charts.
  FigureDrawer();

  /// 600 x 360 CSS pixels, ASCII. `remark`: what has to be seen beside the chart, or nothing.
  std::string svg_of(const Chart& chart, const std::string& remark);

 private:
  struct Closing {
    void operator()(void* engine) const;
  };
  std::unique_ptr<void, Closing> engine_;
};

}  // namespace thermorig::report
