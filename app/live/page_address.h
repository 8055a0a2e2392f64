// SPDX-License-Identifier: MIT
#pragma once

#include "thermorig/io/web/server.h"

namespace thermorig::app {

/// Prints where the page is, and what is to be said of its state file, once: on standard output or, where
/// that is for programs, on standard error. No token goes into a file that others may read: then it is said
/// where the whole address is.
void tell_page(const web::Server& page, bool json);

}  // namespace thermorig::app
