// SPDX-License-Identifier: MIT
#include "commands.h"
#include "existing_file.h"
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

}  // namespace

/// Until Ctrl-C.
ExitCode run(const ViewOptions& options) {
  require_page();
  require_existing(options.file);
  refuse_journal(options.file);
  const view::SessionView view(options.file);
  hold_interrupts();
  web::ServerOptions served;
  served.port = options.port;
  served.data = [&view](std::string_view name) { return view::served_part(view, name); };
  const web::Server server(served, no_orders);
  print("session  {}, {} frames\n", printable(options.file.string()), count_text(view.frames()));
  tell_page(server, false);
  print("Ctrl-C ends it\n");
  flush_output();
  wait_for_interrupt();
  return ExitCode::ok;
}

}  // namespace thermorig::app
