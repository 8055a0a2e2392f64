// SPDX-License-Identifier: MIT
#include "html.h"

#include <cctype>

#include "page.h"
#include "text.h"

namespace thermorig::report {
namespace {

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : clean(text)) switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      case '\'':
        out += "&#39;";
        break;
      default:
        out += c;
    }
  return out;
}

/// JSON for a script element: no character in it can end the element or start a comment.
std::string script_data(const nlohmann::json& data) {
  std::string out;
  for (const char c : data.dump(-1, ' ', true, nlohmann::json::error_handler_t::replace)) {
    if (c == '<')
      out += "\\u003c";
    else if (c == '>')
      out += "\\u003e";
    else if (c == '&')
      out += "\\u0026";
    else
      out += c;
  }
  return out;
}

bool is_number(const std::string& cell) {
  const std::size_t first = cell.starts_with('-') ? 1 : 0;
  return cell == no_value ||
         (first < cell.size() && std::isdigit(static_cast<unsigned char>(cell[first])) != 0);
}

std::string cell_of(const Table& table, std::size_t column, const std::string& text) {
  if (column == 0) return "<th scope=\"row\">" + escaped(text) + "</th>";
  const std::string content =
      table.emphasised == column ? "<strong>" + escaped(text) + "</strong>" : escaped(text);
  return (is_number(text) ? "<td class=\"number\">" : "<td>") + content + "</td>";
}

std::string groups_of(const Table& table) {
  if (table.groups.empty()) return "";
  std::string row = "<tr>";
  for (const ColumnGroup& group : table.groups)
    row += "<th scope=\"colgroup\" colspan=\"" + std::to_string(group.columns) + "\">" +
           escaped(group.title) + "</th>";
  return row + "</tr>\n";
}

/// Where a group begins, for the line before it.
std::vector<bool> starts_of(const Table& table) {
  std::vector<bool> starts(table.header.size(), false);
  std::size_t column = 0;
  for (const ColumnGroup& group : table.groups) {
    if (column > 0 && column < starts.size()) starts[column] = true;
    column += group.columns;
  }
  return starts;
}

std::string table_of(const Table& table) {
  std::string out = "<div class=\"table\"><table>\n<caption>" + escaped(table.caption) + "</caption>\n";
  const auto starts = starts_of(table);
  out += "<colgroup>";
  for (const bool start : starts) out += start ? "<col class=\"start\">" : "<col>";
  out += "</colgroup>\n<thead>" + groups_of(table) + "<tr>";
  for (const std::string& title : table.header) out += "<th scope=\"col\">" + escaped(title) + "</th>";
  out += "</tr></thead>\n<tbody>\n";
  for (const auto& row : table.rows) {
    out += "<tr>";
    for (std::size_t column = 0; column < row.size(); ++column) out += cell_of(table, column, row[column]);
    out += "</tr>\n";
  }
  return out + "</tbody></table></div>\n";
}

/// Content of the page, and the charts' data that the script draws into it.
struct HtmlWriter {
  std::string& out;
  nlohmann::json& charts;

  void operator()(const Paragraph& paragraph) const { out += "<p>" + escaped(paragraph.text) + "</p>\n"; }
  void operator()(const Table& table) const {
    if (!table.folded) {
      out += table_of(table);
      return;
    }
    out += "<details><summary>" + escaped(table.caption) + "</summary>\n" + table_of(table) + "</details>\n";
  }
  void operator()(const Charts& group) const {
    out += group.small ? "<div class=\"charts small\">\n" : "<div class=\"charts\">\n";
    for (const Chart& chart : group.charts) {
      out += "<figure><figcaption>" + escaped(chart.title) +
             "</figcaption><div class=\"chart\" role=\"img\" " + "data-chart=\"" +
             std::to_string(charts.size()) + "\" aria-label=\"" + escaped(chart.label) +
             "\"></div></figure>\n";
      charts.push_back(chart.data);
    }
    out += "</div>\n";
  }
};

std::string id_of(std::size_t index) {
  return "part-" + std::to_string(index + 1);
}

std::string contents_of(const Document& document) {
  std::string out = "<nav aria-label=\"Contents\"><ul>\n";
  for (std::size_t i = 0; i < document.sections.size(); ++i)
    out += "<li><a href=\"#" + id_of(i) + "\">" + escaped(document.sections[i].heading) + "</a></li>\n";
  return out + "</ul></nav>\n";
}

}  // namespace

std::string html_of(const Document& document) {
  std::string content = "<h1>" + escaped(document.title) + "</h1>\n";
  if (!document.banner.empty()) content += "<p class=\"banner\">" + escaped(document.banner) + "</p>\n";
  content += contents_of(document);
  auto charts = nlohmann::json::array();
  for (std::size_t i = 0; i < document.sections.size(); ++i) {
    content += "<section aria-labelledby=\"" + id_of(i) + "\">\n<h2 id=\"" + id_of(i) + "\">" +
               escaped(document.sections[i].heading) + "</h2>\n";
    for (const Block& block : document.sections[i].blocks) std::visit(HtmlWriter{content, charts}, block);
    content += "</section>\n";
  }
  std::string page(page_parts[0]);
  page += escaped(document.title);
  page += page_parts[1];
  page += content;
  page += page_parts[2];
  page += script_data(charts);
  page += page_parts[3];
  return page;
}

}  // namespace thermorig::report
