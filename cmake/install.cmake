# What `cmake --install` puts where: the program, its configuration, and the libraries for other CMake projects.
include(CMakePackageConfigHelpers)
include(GNUInstallDirs)

install(TARGETS fjr EXPORT fjrTargets RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
# The chain factorisation has the name of another library (planner/solver/kkt/ma27.h): a folder of its own keeps it from
# being taken for that by anybody else.
install(TARGETS fjr_kkt EXPORT fjrTargets LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/fjr)
set_target_properties(fjr PROPERTIES INSTALL_RPATH "$ORIGIN/../${CMAKE_INSTALL_LIBDIR}/fjr")
install(TARGETS fjr_model fjr_planner
  EXPORT fjrTargets
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
  LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}
  INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/fjr)
install(DIRECTORY config/ DESTINATION ${CMAKE_INSTALL_DATADIR}/fjr/config USE_SOURCE_PERMISSIONS)
install(DIRECTORY model planner
  DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/fjr
  FILES_MATCHING PATTERN "*.h"
  PATTERN planner/program EXCLUDE)

set(fjr_package ${CMAKE_INSTALL_LIBDIR}/cmake/fjr)
install(EXPORT fjrTargets NAMESPACE fjr:: DESTINATION ${fjr_package})
configure_package_config_file(cmake/fjrConfig.cmake.in ${PROJECT_BINARY_DIR}/cmake/fjrConfig.cmake
  INSTALL_DESTINATION ${fjr_package})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/cmake/fjrConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/cmake/fjrConfig.cmake ${PROJECT_BINARY_DIR}/cmake/fjrConfigVersion.cmake
  DESTINATION ${fjr_package})
