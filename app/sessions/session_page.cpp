// SPDX-License-Identifier: MIT
#include "session_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "export_files.h"
#include "plot_files.h"
#include "print/output.h"
#include "session_files.h"
#include "thermorig/io/spill/spill.h"
#include "thermorig/io/web/server.h"
#include "thermorig/io/web/session_document.h"
#include "thermorig/storage/session/rows.h"
#include "thermorig/storage/view/packed_session.h"

namespace thermorig::app {

namespace {

constexpr std::size_t document_bytes_max = 5'000'000;

bool is_to_standard_output(const InspectOptions& options) {
  return options.html == "-";
}

void check_words(const InspectOptions& options) {
  if (options.paths.size() != 1)
    throw Error(ExitCode::bad_usage, "--html takes one session", "", "call it once for each session");
  if (options.check || options.timing)
    throw Error(ExitCode::bad_usage, "--html writes a page, and says nothing else of a session", "",
                "leave out --check and --timing");
  if (is_to_standard_output(options) && options.json)
    throw Error(ExitCode::bad_usage, "standard output takes the page, and nothing else", "--html -",
                "leave out --json");
}

std::string document_of(const std::filesystem::path& path, view::PackedSession& packed) {
  std::vector<web::DocumentPart> parts;
  for (view::PackedPart& part : packed.parts) parts.push_back({std::move(part.name), std::move(part.base64)});
  return web::session_document(path.filename().string() + " · thermorig", parts);
}

/// The child's word for it: nobody else has read the file.
bool is_simulated(const view::PackedSession& packed) {
  const nlohmann::json facts = nlohmann::json::parse(packed.facts, nullptr, false);
  return facts.is_object() && facts.value("simulated", nlohmann::json()) == true;
}

void print_written(const InspectOptions& options, const std::filesystem::path& session,
                   const view::PackedSession& packed, std::size_t bytes) {
  if (options.json) {
    print_json({{"session", session.string()},
                {"simulated", is_simulated(packed)},
                {"html", options.html.string()},
                {"bytes", bytes},
                {"frames", packed.frames},
                {"row_every", packed.row_every},
                {"image_every", packed.image_every}});
    return;
  }
  print("session   {}\n{}", printable(session.string()), is_simulated(packed) ? "rig       SIMULATED\n" : "");
  print("written   {}: {}\n", printable(options.html.string()), bytes_text(bytes));
  if (!packed.left_out.empty()) print("left out  {}\n", packed.left_out);
}

/// As one looks at the scene; nothing if no frame is valid.
std::vector<float> first_valid_image(const session::StoredFile& file, const session::Rows& rows) {
  const std::vector<LabelledSample>& samples = rows.session.samples;
  const auto found = std::ranges::find_if(samples, &LabelledSample::valid);
  if (found == samples.end()) return {};
  const auto index = static_cast<std::uint64_t>(found - samples.begin());
  const session::Images images = session::read_images(file, {index, 1});
  std::vector<float> pixels(images.frames.front().temp_c.begin(), images.frames.front().temp_c.end());
  for (std::size_t row = 0; images.mirrored && row < frame_rows; ++row)
    std::reverse(pixels.begin() + row * frame_columns, pixels.begin() + (row + 1) * frame_columns);
  return pixels;
}

}  // namespace

void require_page() {
  if (!web::page_is_built())
    throw Error(ExitCode::failed, "this program was built without its page", "",
                "bash app/setup.sh page, then cmake --preset release && cmake --build build");
}

ExitCode write_session_page(const InspectOptions& options) {
  check_words(options);
  require_page();
  const std::filesystem::path path = one_session_at(options.paths.front());
  refuse_journal(path);
  if (!is_to_standard_output(options)) require_new(options.html, "another name, or remove it first");
  view::PackedSession packed =
      view::packed_session(path, document_bytes_max - web::session_document("", {}).size());
  const std::string document = document_of(path, packed);
  if (is_to_standard_output(options)) {
    write_to(stdout, document);
    require_printed();
    return ExitCode::ok;
  }
  ExportFile file(options.html);
  file.write(std::string_view(document));
  file.publish();
  print_written(options, path, packed, document.size());
  return ExitCode::ok;
}

ExitCode write_session_plots(const InspectOptions& options) {
  if (options.check || options.timing)
    throw Error(ExitCode::bad_usage, "--plots writes figures, and says nothing else of a session", "",
                "leave out --check and --timing");
  require_plots_possible(options.plots);
  const std::vector<std::filesystem::path> sessions = session_files_at(options.paths);
  nlohmann::json list = nlohmann::json::array();
  for (const std::filesystem::path& path : sessions) {
    refuse_journal(path);
    spill::arrays_near(path);
    const session::StoredFile file(path);
    const session::Rows rows = session::read_rows(file);
    const std::vector<report::PlotFile> plots = report::session_plots(rows, first_valid_image(file, rows));
    const std::filesystem::path folder = sessions.size() == 1 ? options.plots : options.plots / path.stem();
    write_plots(folder, plots);
    const bool simulated = rows.session.raw.header.simulated;
    if (options.json)
      list.push_back({{"session", path.string()}, {"simulated", simulated}, {"plots", folder.string()}});
    else
      print("session   {}\n{}plots     {}\n", printable(path.string()),
            simulated ? "rig       SIMULATED\n" : "", printable(folder.string()));
  }
  if (options.json) print_json(list);
  return ExitCode::ok;
}

}  // namespace thermorig::app
