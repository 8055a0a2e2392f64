// SPDX-License-Identifier: MIT
#include "markdown.h"

#include "text.h"

namespace thermorig::report {
namespace {

/// Plain text as Markdown shows it: nothing in a name may become a link, a tag or a new cell.
std::string escaped_markdown(const std::string& text) {
  static const std::string special = "\\`*_[]<>|#&~";
  std::string out;
  for (const char c : clean(text)) {
    if (special.find(c) != std::string::npos) out += '\\';
    out += c;
  }
  return out;
}

std::string line_of(const std::vector<std::string>& cells) {
  std::string line = "|";
  for (const std::string& cell : cells) line += ' ' + cell + " |";
  return line + '\n';
}

std::vector<std::string> header_of(const Table& table) {
  std::vector<std::string> header;
  for (const std::string& title : table.header) header.push_back(escaped_markdown(title));
  std::size_t column = 0;
  for (const ColumnGroup& group : table.groups)
    for (std::size_t i = 0; i < group.columns && column < header.size(); ++i, ++column)
      if (!group.title.empty()) header[column] = escaped_markdown(group.title) + ": " + header[column];
  return header;
}

struct MarkdownWriter {
  std::string& out;

  void operator()(const Paragraph& paragraph) const { out += escaped_markdown(paragraph.text) + "\n\n"; }
  void operator()(const Charts&) const {}
  void operator()(const Table& table) const {
    if (!table.caption.empty()) out += "**" + escaped_markdown(table.caption) + "**\n\n";
    out += line_of(header_of(table));
    out += line_of(std::vector<std::string>(table.header.size(), "---"));
    for (const auto& row : table.rows) {
      std::vector<std::string> cells;
      for (const std::string& cell : row) cells.push_back(escaped_markdown(cell));
      out += line_of(cells);
    }
    out += '\n';
  }
};

}  // namespace

std::string markdown_of(const Document& document) {
  std::string out = "# " + escaped_markdown(document.title) + "\n\n";
  if (!document.banner.empty()) out += "> **" + escaped_markdown(document.banner) + "**\n\n";
  for (const Section& section : document.sections) {
    out += "## " + escaped_markdown(section.heading) + "\n\n";
    for (const Block& block : section.blocks) std::visit(MarkdownWriter{out}, block);
  }
  out.pop_back();  // one line end closes the file
  return out;
}

}  // namespace thermorig::report
