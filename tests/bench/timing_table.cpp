// SPDX-License-Identifier: MIT
// How well times and labels hold, in virtual time against the simulator's truth, beside what others do with
// the same bytes. Usage: timing_table [--json] [--quick] [--first-seed N] [--world NAME]
#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>
#include <vector>

#include "timing_clocks.h"
#include "timing_cost.h"
#include "timing_figures.h"
#include "timing_labels.h"
#include "timing_rig.h"

int main(int count, char** arguments) {
  using namespace thermorig::bench;
  TableSize size;
  const auto options = table_options(
      count, arguments, "timing_table [--json] [--quick] [--first-seed N] [--world NAME]", size.first_seed);
  if (!options) return 2;
  size.first_seed = options->first_seed;
  if (options->quick) {
    size.seeds = 3;
    size.seconds = 60.0;
    size.long_seconds = 600.0;
  }
  if (!options->world.empty()) choose_world(options->world);
  const auto begin = std::chrono::steady_clock::now();
  std::vector<Figure> figures;
  add_cost(size, figures);
  add_long_servo_clock(size, figures);
  add_outage(size, figures);
  // Elsewhere the boards are late by more than this section knows of.
  if (chosen_world() == "honest") add_camera_offset(size, figures);
  add_labels(size, figures);
  add_sample_times(size, figures);
  if (chosen_world() != "honest") drop_limits(figures);
  const double took_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  if (options->json) {
    print_json(figures);
    return 0;
  }
  fmt::print(
      "Simulated rigs in virtual time, {} world: {} seeds of {:g} s each, from seed {} on; made in "
      "{:.0f} s.\n",
      chosen_world(), size.seeds, size.seconds, size.first_seed, took_s);
  print_text(figures);
  return 0;
}
