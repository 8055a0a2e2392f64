// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>

#include "html.h"
#include "markdown.h"
#include "plots.h"
#include "sections.h"
#include "text.h"
#include "thermorig/learning/report/report.h"

namespace thermorig::report {
namespace {

std::vector<Section> sections_of(const StudyView& view) {
  return {overview_section(view), frame_sweep_section(view), reduction_sweep_section(view),
          claims_section(view),   seeds_section(view),       gate_section(view),
          angle_section(view),    speed_section(view),       cost_section(view),
          training_section(view), folds_section(view)};
}

std::string banner_of(const std::vector<StudyView>& views) {
  std::string banner;
  if (std::any_of(views.begin(), views.end(), [](const StudyView& view) { return view.simulated; }))
    banner =
        "SIMULATED: these data come from the simulated rig, not from devices. They show trends; they say "
        "nothing about accuracy in the real world.";
  if (views.size() > 1)
    banner += fmt::format(
        "{}The results are of {} studies that differ in data, preset, epochs or end frames; "
        "each has its own tables.",
        banner.empty() ? "" : " ", views.size());
  return banner;
}

/// Headings tell several studies in one folder apart.
std::string part_text(const StudyView& view, std::size_t index) {
  return fmt::format("Study {} (preset {}, {} epochs, data {}): ", index + 1, clean(view.preset), view.epochs,
                     clean(view.data_hash).substr(0, 8));
}

Document document_of(std::span<const study::JobResult> results) {
  const auto views = views_of(results);
  Document document;
  document.title = "The study of the paper";
  document.banner = banner_of(views);
  for (std::size_t i = 0; i < views.size(); ++i)
    for (Section& section : sections_of(views[i])) {
      if (views.size() > 1) section.heading = part_text(views[i], i) + section.heading;
      document.sections.push_back(std::move(section));
    }
  return document;
}

}  // namespace

std::string study_markdown(std::span<const study::JobResult> results) {
  return markdown_of(document_of(results));
}

std::string study_html(std::span<const study::JobResult> results) {
  return html_of(document_of(results));
}

std::vector<PlotFile> study_plots(std::span<const study::JobResult> results) {
  return plots_of(document_of(results), std::ranges::any_of(results, &study::JobResult::simulated));
}

}  // namespace thermorig::report
