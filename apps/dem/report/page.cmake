# Writes the C++ source that holds the page of a report: the template with style, scripts and the
# licence of the chart library put in.
#
#   cmake -DFOLDER=apps/dem/report -DCHART_JS=chart.min.js -DSOURCE=report_page.cpp -P page.cmake
file(READ ${FOLDER}/template.html page)
foreach(part "report.css;${FOLDER}/report.css" "report.js;${FOLDER}/report.js" "chart.js;${CHART_JS}")
  list(GET part 0 name)
  list(GET part 1 path)
  file(READ ${path} text)
  if(text MATCHES "</(script|style)")
    message(FATAL_ERROR "${path} holds ${CMAKE_MATCH_0}, which would end its element in the page")
  endif()
  string(REPLACE "@${name}@" "${text}" page "${page}")
endforeach()

file(WRITE ${SOURCE}.html "${page}")
file(READ ${SOURCE}.html bytes HEX)
file(REMOVE ${SOURCE}.html)
string(REGEX REPLACE "(..)" "0x\\1," bytes "${bytes}")
string(REGEX REPLACE "(................................................................................)" "\\1\n"
       bytes "${bytes}")
file(WRITE ${SOURCE}
"#include <string_view>

namespace dem::app {
namespace {
constexpr unsigned char kBytes[] = {
${bytes}};
}
extern const std::string_view report_page;
const std::string_view report_page{reinterpret_cast<const char*>(kBytes), sizeof kBytes};
}  // namespace dem::app
")
