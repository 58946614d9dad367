# Chart.js as Debian ships it (libjs-chart.js), turned into a string of the program: reports stand alone, without network.
find_file(CHART_JS chart.min.js PATHS /usr/share/javascript/chart.js REQUIRED NO_CACHE)
file(READ ${CHART_JS} CHART_JS_TEXT)
configure_file(${PROJECT_SOURCE_DIR}/cmake/chart_js.cc.in ${PROJECT_BINARY_DIR}/chart_js.cc @ONLY)
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${CHART_JS})
