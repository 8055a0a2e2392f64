// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "document.h"

namespace thermorig::report {

/// The document as GitHub-flavoured Markdown; charts are left out, their figures stand in the tables.
std::string markdown_of(const Document& document);

}  // namespace thermorig::report
