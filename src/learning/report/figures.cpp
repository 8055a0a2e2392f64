// SPDX-License-Identifier: MIT
#include "figures.h"

#include <duktape.h>

#include "page.h"
#include "text.h"
#include "thermorig/core/error.h"
#include "thermorig/learning/report/report.h"

namespace thermorig::report {
namespace {

[[noreturn]] void refuse_figure(duk_context* engine, const std::string& what) {
  throw Error(ExitCode::failed, "a figure cannot be drawn: " + std::string(duk_safe_to_string(engine, -1)),
              what, "the report's HTML (-o) has the same charts");
}

/// Runs within the engine's protection, as what is not JSON would end the program elsewhere.
duk_ret_t call_figure(duk_context* engine, void* /*unused*/) {
  duk_json_decode(engine, -2);  // chart
  duk_get_global_string(engine, "figure");
  duk_insert(engine, -3);
  duk_call(engine, 2);
  duk_require_string(engine, -1);
  return 1;
}

}  // namespace

void FigureDrawer::Closing::operator()(void* engine) const {
  duk_destroy_heap(static_cast<duk_context*>(engine));
}

void require_charts() {
  if (draws_charts()) return;
  throw Error(ExitCode::failed, "this program draws no charts: it was built without node", "",
              "bash app/setup.sh page, then cmake --preset release && cmake --build build");
}

FigureDrawer::FigureDrawer() {
  require_charts();
  engine_.reset(duk_create_heap_default());
  if (engine_ == nullptr) throw std::bad_alloc();
  auto* const engine = static_cast<duk_context*>(engine_.get());
  if (duk_peval_lstring_noresult(engine, figure_script.data(), figure_script.size()) != 0)
    refuse_figure(engine, "");
}

std::string FigureDrawer::svg_of(const Chart& chart, const std::string& remark) {
  auto* const engine = static_cast<duk_context*>(engine_.get());
  const std::string data = chart.data.dump(-1, ' ', true, nlohmann::json::error_handler_t::replace);
  duk_push_lstring(engine, data.data(), data.size());
  duk_push_lstring(engine, remark.data(), remark.size());
  if (duk_safe_call(engine, call_figure, nullptr, 2, 1) != DUK_EXEC_SUCCESS)
    refuse_figure(engine, clean(chart.title));
  std::size_t size = 0;
  const char* text = duk_get_lstring(engine, -1, &size);
  std::string svg(text, size);
  duk_pop(engine);
  return svg;
}

}  // namespace thermorig::report
