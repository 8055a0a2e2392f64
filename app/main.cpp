// SPDX-License-Identifier: MIT
#include <csignal>
#include <cstdio>
#include <exception>
#include <new>
#include <string_view>
#include <variant>

#include "commands.h"
#include "error_output.h"
#include "options.h"
#include "thermorig/core/error.h"

namespace {

using namespace thermorig;

/// Known before parsing, so that an error in the command line is told in the form that was asked for.
bool asks_for_json(int argc, const char* const* argv) {
  for (int i = 1; i < argc; ++i)
    if (std::string_view(argv[i]) == "--json") return true;
  return false;
}

int run(int argc, const char* const* argv) {
  const app::CommandLine line = app::parse(argc, argv);
  if (!line.command) {
    std::fputs(line.help.c_str(), stdout);
    return static_cast<int>(ExitCode::ok);
  }
  return static_cast<int>(std::visit([](const auto& options) { return app::run(options); }, *line.command));
}

int flushed(int code) {
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return code;
  throw Error(ExitCode::storage, "the output could not be written", "standard output",
              "free some space; where another program read it, keep that one running");
}

}  // namespace

int main(int argc, char** argv) {
  std::signal(SIGXFSZ, SIG_IGN);  // a file that may not grow is then an error of write(), as a full disk is
  const bool json = asks_for_json(argc, argv);
  try {
    return flushed(run(argc, argv));
  } catch (const Error& error) {
    return app::report(error, json);
  } catch (const std::bad_alloc&) {
    return app::report(Error(ExitCode::failed, "there is not enough memory", "", "close other programs"),
                       json);
  } catch (const std::exception& error) {
    return app::report(Error(ExitCode::failed, error.what(), "", ""), json);
  }
}
