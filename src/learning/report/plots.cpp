// SPDX-License-Identifier: MIT
// Charts and tables as files that LaTeX and spreadsheets take.
#include "plots.h"

#include <fmt/format.h>

#include <map>

#include "figures.h"
#include "html.h"
#include "text.h"

namespace thermorig::report {
namespace {

constexpr const char* simulated_remark = "SIMULATED data";

/// What means something else to LaTeX, or is not in every font of it. A row that begins with "[" or "*" would
/// be an argument of the \\ before it.
const std::map<std::string, std::string, std::less<>> latex_of{{"\\", "\\textbackslash{}"},
                                                               {"{", "\\{"},
                                                               {"}", "\\}"},
                                                               {"$", "\\$"},
                                                               {"&", "\\&"},
                                                               {"#", "\\#"},
                                                               {"_", "\\_"},
                                                               {"%", "\\%"},
                                                               {"~", "\\textasciitilde{}"},
                                                               {"^", "\\^{}"},
                                                               {"<", "$<$"},
                                                               {">", "$>$"},
                                                               {"|", "$|$"},
                                                               {"[", "{[}"},
                                                               {"*", "{*}"},
                                                               {"\"", "''"},
                                                               {"\u00b0", "$^\\circ$"},
                                                               {"\u00b1", "$\\pm$"},
                                                               {"\u00b5", "$\\mu$"},
                                                               {"\u00d7", "$\\times$"},
                                                               {"\u00a0", "~"},
                                                               {"\u2212", "$-$"}};

/// Letters of Latin-1: what a document without further packages takes beside ASCII.
bool is_known_to_latex(const std::string& one) {
  return one.size() == 1 || (one.size() == 2 && one[0] == '\xC3');
}

std::string latex_text(const std::string& text) {
  const std::string plain = clean(text);
  std::string out;
  for (std::size_t at = 0; at < plain.size();) {
    std::size_t size = 1;
    while (at + size < plain.size() && (static_cast<unsigned char>(plain[at + size]) & 0xC0U) == 0x80U)
      ++size;
    const std::string one = plain.substr(at, size);
    const auto found = latex_of.find(one);
    out += found != latex_of.end() ? found->second : is_known_to_latex(one) ? one : "?";
    at += size;
  }
  return out;
}

/// A hyphen before a figure is a minus.
std::string latex_cell(const std::string& cell) {
  const bool is_negative = cell.size() > 1 && cell[0] == '-' && cell[1] >= '0' && cell[1] <= '9';
  return is_negative ? "$-$" + latex_text(cell.substr(1)) : latex_text(cell);
}

std::string latex_row(const std::vector<std::string>& cells) {
  std::string row;
  for (std::size_t i = 0; i < cells.size(); ++i) row += (i == 0 ? "" : " & ") + latex_cell(cells[i]);
  return row + " \\\\\n";
}

std::string latex_groups(const Table& table) {
  if (table.groups.empty()) return "";
  std::string titles, rules;
  std::size_t column = 1;
  for (const ColumnGroup& group : table.groups) {
    titles += fmt::format("{}\\multicolumn{{{}}}{{c}}{{{}}}", column == 1 ? "" : " & ", group.columns,
                          latex_text(group.title));
    if (!group.title.empty())
      rules += fmt::format("\\cmidrule(lr){{{}-{}}}", column, column + group.columns - 1);
    column += group.columns;
  }
  return titles + " \\\\\n" + (rules.empty() ? "" : rules + "\n");
}

std::string caption_of(const Table& table, bool simulated) {
  const std::string caption = clean(table.caption.empty() ? table.name : table.caption);
  const bool says_so = !simulated || caption.find("SIMULATED") != std::string::npos;
  return says_so ? caption : fmt::format("{} ({})", caption, simulated_remark);
}

/// To be put in with \input, within a table that has a caption of its own.
std::string latex_of_table(const Table& table, bool simulated) {
  std::string columns;
  for (const bool is_number : number_columns(table)) columns += is_number && !columns.empty() ? 'r' : 'l';
  std::string out = "% " + caption_of(table, simulated) +
                    "\n% needs \\usepackage{booktabs}\n\\begin{tabular}{" + columns + "}\n\\toprule\n" +
                    latex_groups(table) + latex_row(table.header) + "\\midrule\n";
  for (const auto& row : table.rows) out += latex_row(row);
  return out + "\\bottomrule\n\\end{tabular}\n";
}

std::string csv_cell(const std::string& text) {
  std::string plain = clean(text);
  if (plain.find_first_of(",\"") == std::string::npos) return plain;
  std::string quoted = "\"";
  for (const char c : plain) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

std::string csv_row(const std::vector<std::string>& cells) {
  std::string row;
  for (std::size_t i = 0; i < cells.size(); ++i) row += (i == 0 ? "" : ",") + csv_cell(cells[i]);
  return row + "\n";
}

/// With the titles of groups before those of their columns: a CSV file has one line of them.
std::string csv_of_table(const Table& table) {
  std::vector<std::string> header = table.header;
  std::size_t column = 0;
  for (const ColumnGroup& group : table.groups)
    for (std::size_t i = 0; i < group.columns && column < header.size(); ++i, ++column)
      if (!group.title.empty()) header[column] = group.title + ": " + header[column];
  std::string out = csv_row(header);
  for (const auto& row : table.rows) out += csv_row(row);
  return out;
}

/// With words for those who cannot see it.
std::string titled(std::string svg, const std::string& label) {
  return svg.insert(svg.find('>') + 1, "<title>" + escaped_html(label) + "</title>");
}

class PlotWriter {
 public:
  explicit PlotWriter(bool simulated) : simulated_(simulated) {}

  void operator()(const Paragraph& /*paragraph*/) {}
  void operator()(const Table& table) {
    if (table.rows.empty()) return;
    const std::string name = own_name("table-" + table.name);
    add_caption(name, caption_of(table, simulated_));
    files_.push_back({name + ".tex", latex_of_table(table, simulated_)});
    files_.push_back({name + ".csv", csv_of_table(table)});
  }
  void operator()(const Charts& group) {
    for (const Chart& chart : group.charts) {
      const std::string name = own_name("fig-" + chart.name);
      add_caption(name, clean(chart.title));
      files_.push_back(
          {name + ".svg", titled(drawer_.svg_of(chart, simulated_ ? simulated_remark : ""), chart.label)});
    }
  }

  std::vector<PlotFile> files() && {
    files_.push_back({"captions.csv", csv_row({"name", "caption"}) + captions_});
    return std::move(files_);
  }

 private:
  std::string own_name(const std::string& name) {
    const int count = ++counts_[name];
    return count == 1 ? name : fmt::format("{}-{}", name, count);
  }
  void add_caption(const std::string& name, const std::string& caption) {
    captions_ += csv_row({name, caption});
  }

  bool simulated_;
  FigureDrawer drawer_;
  std::map<std::string, int> counts_;
  std::string captions_;
  std::vector<PlotFile> files_;
};

}  // namespace

std::vector<PlotFile> plots_of(const Document& document, bool simulated) {
  PlotWriter writer(simulated);
  for (const Section& section : document.sections)
    for (const Block& block : section.blocks) std::visit(writer, block);
  return std::move(writer).files();
}

}  // namespace thermorig::report
