// SPDX-License-Identifier: MIT
#include <nlohmann/json.hpp>

#include "commands.h"
#include "interrupts.h"
#include "live/page_address.h"
#include "print/output.h"
#include "session_files.h"
#include "session_page.h"
#include "thermorig/io/web/server.h"
#include "thermorig/storage/view/session_view.h"

namespace thermorig::app {

namespace {

void no_orders(const web::Order& /*order*/) {}

void tell(const ViewOptions& options, const web::Server& server, std::uint64_t frames) {
  if (options.json)
    print_json({{"event", "ready"},
                {"session", options.file.string()},
                {"frames", frames},
                {"page_port", server.port()}});
  else
    print("session  {}, {} frames\n", printable(options.file.string()), count_text(frames));
  tell_page(server, options.json);
  if (!options.json) print("Ctrl-C ends it\n");
  flush_output();
}

}  // namespace

/// Until Ctrl-C.
ExitCode run(const ViewOptions& asked) {
  require_page();
  ViewOptions options = asked;
  options.file = asked.json ? one_session_at(asked.file) : chosen_session_at(asked.file);
  refuse_journal(options.file);
  const view::SessionView view(options.file);
  hold_interrupts();
  web::ServerOptions served;
  served.port = options.port;
  served.state_file = web::default_state_file();  // `live`'s is left alone
  if (!served.state_file.empty()) served.state_file.replace_filename("view.json");
  served.data = [&view](std::string_view name) { return view::served_part(view, name); };
  const web::Server server(served, no_orders);
  tell(options, server, view.frames());
  wait_for_interrupt();
  if (options.json) print_json({{"event", "summary"}, {"exit_code", 0}});
  return ExitCode::ok;
}

}  // namespace thermorig::app
