// SPDX-License-Identifier: MIT
#pragma once

#include <sys/wait.h>
#include <unistd.h>

#include <string>

#include "thermorig/core/error.h"

namespace thermorig::tests {

/// The code of the Error that `action` throws, with `advice` in what it says to try, else 0: in a process of
/// a user whom permissions hold back, as they do not root.
template <typename Action>
int code_as_nobody(Action action, const std::string& advice = "") {
  const pid_t process = ::fork();
  if (process == 0) {
    constexpr uid_t nobody = 65534;
    if (::geteuid() == 0 && ::setresuid(nobody, nobody, nobody) != 0) ::_exit(99);
    try {
      action();
    } catch (const Error& error) {
      ::_exit(error.advice().find(advice) == std::string::npos ? 98 : static_cast<int>(error.code()));
    }
    ::_exit(0);
  }
  int status = 0;
  ::waitpid(process, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

}  // namespace thermorig::tests
