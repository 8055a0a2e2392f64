// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <string_view>

namespace thermorig::report {

/// The page around a report: what stands before its title, between title and content, between content and the
/// charts' data, and after them. Made from charts/page.html by charts/build.mjs.
extern const std::array<std::string_view, 4> page_parts;

/// Defines `figure(chart, remark)`, which gives a chart as SVG. Made from charts/figure.js; empty without
/// charts.
extern const std::string_view figure_script;

/// Whether these draw charts; else they say how to get them.
extern const bool has_charts;

}  // namespace thermorig::report
