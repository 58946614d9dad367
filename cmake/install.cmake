# What `cmake --install` puts where: the program, its configuration, and the libraries for other CMake projects.
include(CMakePackageConfigHelpers)
include(GNUInstallDirs)

install(TARGETS fjr EXPORT fjrTargets RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
# The chain factorisation has the symbols of another library (planner/solver/kkt/ma27.h): a folder of its own keeps it
# from being linked by anybody else.
install(TARGETS fjr_kkt EXPORT fjrTargets LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/fjr)
set_target_properties(fjr PROPERTIES INSTALL_RPATH "$ORIGIN/../${CMAKE_INSTALL_LIBDIR}/fjr")
install(TARGETS fjr_model fjr_planner
  EXPORT fjrTargets
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
  LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}
  INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/fjr)
install(DIRECTORY config/ DESTINATION ${CMAKE_INSTALL_DATADIR}/fjr/config USE_SOURCE_PERMISSIONS)
install(DIRECTORY idl/ DESTINATION ${CMAKE_INSTALL_DATADIR}/fjr/idl FILES_MATCHING PATTERN "*.idl")
# The unit names the program by its full path, which is known when it is installed (--prefix). systemd looks in
# /usr/lib and /usr/local/lib; from elsewhere: `systemctl link`.
install(CODE "
  set(FJR_BIN \"\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_BINDIR}\")
  set(FJR_DATA \"\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_DATADIR}\")
  configure_file(\"${PROJECT_SOURCE_DIR}/cmake/fjr.service.in\" \"${PROJECT_BINARY_DIR}/cmake/fjr.service\" @ONLY)
  file(INSTALL \"${PROJECT_BINARY_DIR}/cmake/fjr.service\" DESTINATION \"\${CMAKE_INSTALL_PREFIX}/lib/systemd/system\")")
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
