// SPDX-License-Identifier: MIT
#include "thermorig/io/web/session_document.h"

#include <fmt/format.h>

#include "assets.h"

namespace thermorig::web {

namespace {

std::string escaped(std::string_view text) {
  std::string safe;
  for (const char c : text) {
    if (c == '<')
      safe += "&lt;";
    else if (c == '&')
      safe += "&amp;";
    else
      safe += c;
  }
  return safe;
}

}  // namespace

std::string session_document(std::string_view title, const std::vector<DocumentPart>& parts) {
  const auto& [before_title, before_data, behind_data] = document_pieces;
  std::string document = fmt::format("{}{}{}", before_title, escaped(title), before_data);
  for (const DocumentPart& part : parts)
    document +=
        fmt::format("<script type=\"text/plain\" id=\"data-{}\">{}</script>\n", part.name, part.base64);
  document += behind_data;
  return document;
}

}  // namespace thermorig::web
