# The report's own HTML, CSS and JavaScript, turned into strings of the program.
foreach(file stage.html plan_page.css plan_page.js)
  string(MAKE_C_IDENTIFIER ${file} variable)
  string(TOUPPER ${variable} variable)
  file(READ ${PROJECT_SOURCE_DIR}/planner/results/report/${file} ${variable})
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/planner/results/report/${file})
endforeach()
configure_file(${PROJECT_SOURCE_DIR}/cmake/plan_page_text.cc.in ${PROJECT_BINARY_DIR}/plan_page_text.cc @ONLY)
