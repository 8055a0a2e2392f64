// SPDX-License-Identifier: MIT
// What stands in for page.cpp where node was not there to make it: the tables of a report, and no charts.
#include "page.h"

namespace thermorig::report {

const bool has_charts = false;

const std::array<std::string_view, 4> page_parts{
    {"<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
     "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src 'unsafe-inline'; "
     "base-uri 'none'; form-action 'none'\">\n"
     "<meta name=\"color-scheme\" content=\"light dark\">\n<meta name=\"generator\" "
     "content=\"thermorig\">\n<title>",
     "</title>\n<style>body{font-family:sans-serif;max-width:70rem;margin:auto;padding:1rem}"
     "th,td{padding:.2rem "
     ".6rem;text-align:left}.number{text-align:right}.chart{display:none}</style>\n</head>\n"
     "<body>\n<p>This report has no charts: the thermorig that wrote it was built without node. To have "
     "them: "
     "bash app/setup.sh page, then cmake --preset release &amp;&amp; cmake --build build, and write the "
     "report again.</p>\n<main>\n",
     "</main>\n<script type=\"application/json\" id=\"charts\">", "</script>\n</body>\n</html>\n"}};

const std::string_view figure_script;

}  // namespace thermorig::report
