// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "document.h"

namespace thermorig::report {

/// The document as one page that needs nothing else: style, script and the charts' data are in it.
std::string html_of(const Document& document);

}  // namespace thermorig::report
