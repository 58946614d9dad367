# The installed units are ones that systemd takes, confined as far as they can be; they name the installed program, the
# machine's configuration, and the credentials that make_credentials.sh makes. An installation does not overwrite the
# machine's configuration.
#   cmake -D BUILD=<build folder> -P tests/systemd_unit.cmake
cmake_minimum_required(VERSION 3.25)

set(prefix ${BUILD}/tests/installed)
file(REMOVE_RECURSE ${prefix})
file(WRITE ${prefix}/etc/fjr/executor.yaml "{robot_id: mine}\n")
execute_process(COMMAND ${CMAKE_COMMAND} --install ${BUILD} --prefix ${prefix} OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)

file(READ ${prefix}/etc/fjr/executor.yaml kept)
if(NOT kept STREQUAL "{robot_id: mine}\n")
  message(FATAL_ERROR "executor.yaml was overwritten: ${kept}")
endif()
foreach(file service.yaml robot.yaml)
  if(NOT EXISTS ${prefix}/etc/fjr/${file})
    message(FATAL_ERROR "etc/fjr/${file} was not installed")
  endif()
endforeach()
execute_process(COMMAND ${prefix}/share/fjr/config/security/make_credentials.sh ${prefix}/etc/fjr/security
  OUTPUT_QUIET ERROR_QUIET COMMAND_ERROR_IS_FATAL ANY)

find_program(analyze systemd-analyze REQUIRED)
# unit(name command credentials exposure): exposure is systemd's score, 0 to 10, in tenths.
function(unit name command credentials exposure)
  set(unit ${prefix}/lib/systemd/system/${name})
  file(STRINGS ${unit} start REGEX "^ExecStart=")
  if(NOT start STREQUAL "ExecStart=${prefix}/bin/fjr ${command}")
    message(FATAL_ERROR "${name}: ${start}")
  endif()
  file(STRINGS ${unit} loaded REGEX "^LoadCredential=")
  list(LENGTH loaded count)
  foreach(line ${loaded})
    string(REGEX REPLACE "^LoadCredential=([^:]*):.*$" "\\1" credential "${line}")
    if(NOT line STREQUAL "LoadCredential=${credential}:${credentials}/${credential}" OR
        NOT EXISTS ${credentials}/${credential})
      message(FATAL_ERROR "${name}: ${line} names no credential of ${credentials}")
    endif()
  endforeach()
  if(NOT count EQUAL 6)
    message(FATAL_ERROR "${name}: ${count} credentials")
  endif()
  execute_process(COMMAND ${analyze} verify ${unit} ERROR_VARIABLE problems COMMAND_ERROR_IS_FATAL ANY)
  if(problems MATCHES "fjr[a-z-]*\\.service")
    message(FATAL_ERROR "${problems}")
  endif()
  execute_process(COMMAND ${analyze} security --offline=true --threshold=${exposure} --no-pager ${unit}
    OUTPUT_VARIABLE table RESULT_VARIABLE result)
  if(NOT result EQUAL 0)
    message(FATAL_ERROR "${name} is exposed more than ${exposure}/100:\n${table}")
  endif()
  string(REGEX MATCH "Overall exposure[^\n]*" overall "${table}")
  message(STATUS "${name}: ${overall}")
endfunction()

unit(fjr.service "serve --config ${prefix}/etc/fjr/service.yaml" ${prefix}/etc/fjr/security/service 15)
unit(fjr-worker.service "serve --worker-only --config ${prefix}/etc/fjr/service.yaml" ${prefix}/etc/fjr/security/worker
  15)
unit(fjr-executor.service "executor --config ${prefix}/etc/fjr/executor.yaml --logs %L/fjr-executor"
  ${prefix}/etc/fjr/security/executor 15)
file(REMOVE_RECURSE ${prefix})
