# The enclosure headers by themselves, in a folder where there is nothing else, and with compilers' options under which
# their bounds would not hold.
#   cmake -D SOURCE=<repository> -D COMPILER=<c++> -D WORK=<folder> -P tests/enclosure/alone.cmake
cmake_minimum_required(VERSION 3.25)

file(REMOVE_RECURSE ${WORK})
file(COPY ${SOURCE}/common/enclosure DESTINATION ${WORK}/common)
file(WRITE ${WORK}/alone.cc "#include \"common/enclosure/held.h\"\nint main() { return enclosure::Ball(1).contains(1.0) ? 0 : 1; }\n")

# Besides each other they include the standard library alone.
file(GLOB headers ${WORK}/common/enclosure/*)
foreach(header ${headers})
  file(STRINGS ${header} foreign REGEX "^[ \t]*#[ \t]*include")
  list(FILTER foreign EXCLUDE REGEX "<[a-z_]+>|\"common/enclosure/[a-z]+\\.h\"")
  if(foreign)
    message(FATAL_ERROR "${header}: ${foreign}")
  endif()
endforeach()

function(compile expected)
  execute_process(COMMAND ${COMPILER} -std=c++20 -Wall -Wextra -Werror -fsyntax-only ${ARGN} -I ${WORK} ${WORK}/alone.cc
    RESULT_VARIABLE result ERROR_VARIABLE errors)
  if(NOT "${result} ${errors}" MATCHES "${expected}")
    message(FATAL_ERROR "with \"${ARGN}\": ${result} ${errors}")
  endif()
endfunction()

compile("^0 $")
foreach(option -ffast-math -funsafe-math-optimizations -freciprocal-math -ffinite-math-only)
  compile("error bounds do not hold with -ffast-math" ${option})
endforeach()
