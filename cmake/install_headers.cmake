# Installs the public headers from FJR_SOURCE to FJR_INCLUDE below the prefix. One that includes another header of this
# project, which nobody would find there, is an error.
cmake_policy(VERSION 3.25)
include(${FJR_SOURCE}/cmake/public_headers.cmake)

foreach(header ${FJR_PUBLIC_HEADERS})
  file(STRINGS ${FJR_SOURCE}/${header} includes REGEX "^#include \"")
  list(TRANSFORM includes REPLACE "^#include \"(.*)\".*$" "\\1")
  foreach(include ${includes})
    if(NOT include IN_LIST FJR_PUBLIC_HEADERS)
      message(FATAL_ERROR "${header} is public and includes ${include}, which is not (cmake/public_headers.cmake)")
    endif()
  endforeach()
  cmake_path(GET header PARENT_PATH folder)
  file(INSTALL ${FJR_SOURCE}/${header} DESTINATION ${CMAKE_INSTALL_PREFIX}/${FJR_INCLUDE}/${folder})
endforeach()
