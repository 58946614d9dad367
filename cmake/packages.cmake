# Debian packages by CPack: fjr, libfjr-dev and, with FJR_PYTHON, python3-fjr. scripts/make_packages.sh makes them.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME fjr)
set(CPACK_PACKAGE_VENDOR "The fjr project")
set(CPACK_PACKAGE_CONTACT "The fjr project <fjr@localhost>")
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_STRIP_FILES ON)
# Units and configuration have absolute names, so everything is installed below DESTDIR.
set(CPACK_SET_DESTDIR ON)
set(CPACK_INSTALL_PREFIX /usr)

set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_COMPONENTS_ALL program dev)
if(FJR_PYTHON)
  list(APPEND CPACK_COMPONENTS_ALL python3)
endif()

# Which packages have the libraries that are linked is read off the files (dpkg-shlibdeps).
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${fjr_library_folder})
set(fjr_same_version "fjr (= ${PROJECT_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE})")

set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME fjr)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SECTION science)
set(CPACK_COMPONENT_PROGRAM_DESCRIPTION "certified trajectories for flexible-joint robots
 Plans, identifies, serves and executes motions of a two-joint arm with elastic
 gears, fastest, gentlest or most efficient within its limits.")
# One thread of BLAS is what plans are made with; openssl makes credentials of a secured service.
set(CPACK_DEBIAN_PROGRAM_PACKAGE_RECOMMENDS "libopenblas0-serial, openssl")
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SUGGESTS "python3-fjr, libfjr-dev")
set(CPACK_DEBIAN_PROGRAM_PACKAGE_CONTROL_EXTRA ${PROJECT_SOURCE_DIR}/cmake/debian/conffiles)

# What fjrConfig.cmake finds, for static libraries leave it to whoever links them.
set(CPACK_DEBIAN_DEV_PACKAGE_NAME libfjr-dev)
set(CPACK_DEBIAN_DEV_PACKAGE_SECTION libdevel)
set(CPACK_COMPONENT_DEV_DESCRIPTION "trajectories for flexible-joint robots, C++ library
 Static libraries, headers and find_package(fjr) of what the program fjr does.")
set(CPACK_DEBIAN_DEV_PACKAGE_SHLIBDEPS OFF)
string(JOIN ", " CPACK_DEBIAN_DEV_PACKAGE_DEPENDS ${fjr_same_version} pkg-config libeigen3-dev libyaml-cpp-dev
  nlohmann-json3-dev libfmt-dev libssl-dev libsundials-dev libceres-dev coinor-libipopt-dev cyclonedds-dev libspdlog-dev
  libsystemd-dev)

set(CPACK_DEBIAN_PYTHON3_PACKAGE_NAME python3-fjr)
set(CPACK_DEBIAN_PYTHON3_PACKAGE_SECTION python)
set(CPACK_COMPONENT_PYTHON3_DESCRIPTION "trajectories for flexible-joint robots, Python package
 Plans, simulates, certifies and identifies in the process that calls it, with
 NumPy arrays, and asks the planning service.")
if(FJR_PYTHON)
  find_package(Python REQUIRED COMPONENTS Interpreter)  # the one of python/
  math(EXPR fjr_next_python "${Python_VERSION_MINOR} + 1")
  string(JOIN ", " CPACK_DEBIAN_PYTHON3_PACKAGE_DEPENDS ${fjr_same_version} python3-numpy
    "python3 (>= 3.${Python_VERSION_MINOR})" "python3 (<< 3.${fjr_next_python})")
  set(CPACK_DEBIAN_PYTHON3_PACKAGE_SUGGESTS "python3-pandas, python3-matplotlib")
endif()
include(CPack)

# What the program is made of, as SPDX; in the package, since it is built before (fjr_sbom).
find_package(Python3 COMPONENTS Interpreter)
if(Python3_FOUND)
  add_custom_command(OUTPUT ${PROJECT_BINARY_DIR}/fjr.spdx.json
    COMMAND ${Python3_EXECUTABLE} ${PROJECT_SOURCE_DIR}/scripts/sbom.py $<TARGET_FILE:fjr_complete> ${PROJECT_BINARY_DIR}/fjr.spdx.json
    DEPENDS fjr_complete scripts/sbom.py scripts/packages.sh docs/architecture.md VERBATIM)
  add_custom_target(fjr_sbom DEPENDS ${PROJECT_BINARY_DIR}/fjr.spdx.json)
endif()
install(FILES ${PROJECT_BINARY_DIR}/fjr.spdx.json DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/fjr OPTIONAL)
