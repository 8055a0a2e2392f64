// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace thermorig::web {

/// Bytes that a document has in it, as base64.
struct DocumentPart {
  std::string_view name;  // the page looks for it by this name: letters, digits and hyphens
  std::string base64;
};

/// The page of a session as one document that needs no server and loads nothing: scripts and styles of this
/// program, and these parts. `title`: any text. Only if page_is_built().
std::string session_document(std::string_view title, const std::vector<DocumentPart>& parts);

}  // namespace thermorig::web
