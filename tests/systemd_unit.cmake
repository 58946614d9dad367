# The installed unit is one that systemd takes, and names the installed program.
#   cmake -D BUILD=<build folder> -P tests/systemd_unit.cmake
cmake_minimum_required(VERSION 3.25)

set(prefix ${BUILD}/tests/installed)
execute_process(COMMAND ${CMAKE_COMMAND} --install ${BUILD} --prefix ${prefix} OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
set(unit ${prefix}/lib/systemd/system/fjr.service)
file(STRINGS ${unit} start REGEX "^ExecStart=")
if(NOT start STREQUAL "ExecStart=${prefix}/bin/fjr serve --config ${prefix}/share/fjr/config/service.yaml")
  message(FATAL_ERROR "${start}")
endif()
find_program(analyze systemd-analyze)
if(analyze)
  execute_process(COMMAND ${analyze} verify ${unit} ERROR_VARIABLE problems COMMAND_ERROR_IS_FATAL ANY)
  if(problems MATCHES "fjr\\.service")
    message(FATAL_ERROR "${problems}")
  endif()
endif()
file(REMOVE_RECURSE ${prefix})
