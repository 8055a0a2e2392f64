// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "document.h"

namespace thermorig::report {

/// The document as one page that needs nothing else: style, script and the charts' data are in it.
std::string html_of(const Document& document);

/// The text, cleaned, for content and attributes of HTML and SVG.
std::string escaped_html(const std::string& text);

}  // namespace thermorig::report
