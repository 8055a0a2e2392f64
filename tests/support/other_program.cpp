// SPDX-License-Identifier: MIT
#include "other_program.h"

#include <sys/wait.h>

#include <array>
#include <cstdio>

namespace thermorig::tests {

Printed run_other(const std::string& command) {
  Printed printed;
  FILE* pipe = ::popen((command + " 2>&1").c_str(), "r");
  if (pipe == nullptr) return printed;
  std::array<char, 4096> buffer{};
  while (const std::size_t count = std::fread(buffer.data(), 1, buffer.size(), pipe))
    printed.text.append(buffer.data(), count);
  const int status = ::pclose(pipe);
  printed.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return printed;
}

Printed run_script(const std::string& name_and_arguments) {
  return run_other(std::string("/usr/bin/python3 ") + THERMORIG_SOURCE_DIR + "/tests/" + name_and_arguments);
}

Printed run_python(const std::string& source) {
  return run_other("/usr/bin/python3 -c '" + source + "'");
}

bool python_has(const std::string& modules) {
  return run_python("import " + modules).code == 0;
}

}  // namespace thermorig::tests
