// SPDX-License-Identifier: MIT
#include "claims.h"
#include "sections.h"

namespace thermorig::report {
namespace {

Table claims_table(const std::vector<Claim>& claims, bool of_paper, bool seeds, const std::string& caption) {
  Table table;
  table.name = of_paper ? "claims" : "own-claims";
  table.caption = caption;
  table.emphasised = 1;
  table.header = {"claim", "on these data", "numbers"};
  for (const Claim& claim : claims)
    if (claim.of_paper == of_paper)
      table.rows.push_back({claim.statement, text_of(claim.verdict, seeds), claim.evidence});
  return table;
}

}  // namespace

Section claims_section(const StudyView& view) {
  const auto claims = claims_of(view);
  const bool seeds = seeds_known(view);
  return {"Claims of the paper on these data",
          {Paragraph{judging_text(view)},
           claims_table(claims, true, seeds,
                        view.simulated ? "Claims of the paper, judged on the SIMULATED rig's data"
                                       : "Claims of the paper, judged on these data"),
           claims_table(claims, false, seeds,
                        "What the paper does not ask: is fusion better than its own input?")}};
}

}  // namespace thermorig::report
