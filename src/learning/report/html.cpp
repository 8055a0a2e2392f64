// SPDX-License-Identifier: MIT
#include "html.h"

#include "page.h"
#include "text.h"
#include "thermorig/learning/report/report.h"

namespace thermorig::report {

std::string escaped_html(const std::string& text) {
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

namespace {

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

std::string element(const std::string& tag, const std::string& attributes, const std::string& content) {
  return "<" + tag + attributes + ">" + content + "</" + tag + ">";
}

std::string row_of(const Table& table, const std::vector<bool>& numbers,
                   const std::vector<std::string>& row) {
  std::string out = "<tr>" + element("th", " scope=\"row\"", escaped_html(row.front()));
  for (std::size_t column = 1; column < row.size(); ++column) {
    const std::string text = escaped_html(row[column]);
    out += element("td", numbers[column] ? " class=\"number\"" : "",
                   table.emphasised == column ? element("strong", "", text) : text);
  }
  return out + "</tr>\n";
}

std::string groups_of(const Table& table) {
  if (table.groups.empty()) return "";
  std::string row = "<tr>";
  for (const ColumnGroup& group : table.groups)
    row += "<th scope=\"colgroup\" colspan=\"" + std::to_string(group.columns) + "\">" +
           escaped_html(group.title) + "</th>";
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

std::string columns_of(const Table& table) {
  std::string out = "<colgroup>";
  for (const bool start : starts_of(table)) out += start ? "<col class=\"start\">" : "<col>";
  return out + "</colgroup>\n";
}

std::string table_of(const Table& table) {
  const auto numbers = number_columns(table);
  std::string out = "<div class=\"table\">";
  out += table.emphasised ? "<table class=\"verdicts\">\n" : "<table>\n";
  out += element("caption", "", escaped_html(table.caption)) + "\n" + columns_of(table);
  out += "<thead>" + groups_of(table) + "<tr>";
  for (std::size_t column = 0; column < table.header.size(); ++column)
    out += element("th", numbers[column] && column > 0 ? " scope=\"col\" class=\"number\"" : " scope=\"col\"",
                   escaped_html(table.header[column]));
  out += "</tr></thead>\n<tbody>\n";
  for (const auto& row : table.rows) out += row_of(table, numbers, row);
  return out + "</tbody></table></div>\n";
}

/// Content of the page, and the charts' data that the script draws into it.
struct HtmlWriter {
  std::string& out;
  nlohmann::json& charts;

  void operator()(const Paragraph& paragraph) const {
    out += "<p>" + escaped_html(paragraph.text) + "</p>\n";
  }
  void operator()(const Table& table) const {
    if (!table.folded) {
      out += table_of(table);
      return;
    }
    out += "<details><summary>" + escaped_html(table.caption) + "</summary>\n" + table_of(table) +
           "</details>\n";
  }
  void operator()(const Charts& group) const {
    out += group.small ? "<div class=\"charts small\">\n" : "<div class=\"charts\">\n";
    for (const Chart& chart : group.charts) {
      out += "<figure><figcaption>" + escaped_html(chart.title) +
             "</figcaption><div class=\"chart\" role=\"img\" " + "data-chart=\"" +
             std::to_string(charts.size()) + "\" aria-label=\"" + escaped_html(chart.label) +
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
    out += "<li><a href=\"#" + id_of(i) + "\">" + escaped_html(document.sections[i].heading) + "</a></li>\n";
  return out + "</ul></nav>\n";
}

}  // namespace

bool draws_charts() {
  return has_charts;
}

std::string html_of(const Document& document) {
  std::string content = "<h1>" + escaped_html(document.title) + "</h1>\n";
  if (!document.banner.empty()) content += "<p class=\"banner\">" + escaped_html(document.banner) + "</p>\n";
  content += contents_of(document);
  auto charts = nlohmann::json::array();
  for (std::size_t i = 0; i < document.sections.size(); ++i) {
    content += "<section aria-labelledby=\"" + id_of(i) + "\">\n<h2 id=\"" + id_of(i) + "\">" +
               escaped_html(document.sections[i].heading) + "</h2>\n";
    for (const Block& block : document.sections[i].blocks) std::visit(HtmlWriter{content, charts}, block);
    content += "</section>\n";
  }
  std::string page(page_parts[0]);
  page += escaped_html(document.title);
  page += page_parts[1];
  page += content;
  page += page_parts[2];
  page += script_data(charts);
  page += page_parts[3];
  return page;
}

}  // namespace thermorig::report
