// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <map>
#include <string>

namespace thermorig::bench {

/// What a worker can be asked to do: one call, e.g. the inference of the next window.
using Tasks = std::map<std::string, std::function<void()>>;

/// Answers lines "task groups calls" on standard input, each with one line of JSON: the median over `groups`
/// of the time of a call, each the mean of `calls` calls, in microseconds: of the processor (all threads of
/// this process) and by the wall clock.
void serve(const Tasks& tasks);

}  // namespace thermorig::bench
