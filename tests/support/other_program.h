// SPDX-License-Identifier: MIT
#pragma once

#include <string>

namespace thermorig::tests {

/// What a program that is not ours printed, both streams, and its exit code.
struct Printed {
  int code = -1;
  std::string text;
};
Printed run_other(const std::string& command);

/// A script of tests/, named from there, run by Debian's Python: "session/falsify.py FILE".
Printed run_script(const std::string& name_and_arguments);

/// A line of Python, without single quotes.
Printed run_python(const std::string& source);

/// Whether Debian's Python has these modules: "h5py, xarray".
bool python_has(const std::string& modules);

}  // namespace thermorig::tests
