# What `cmake --install` puts where: the program, its configuration, and the libraries for other CMake projects.
include(CMakePackageConfigHelpers)
include(GNUInstallDirs)
set(CMAKE_INSTALL_DEFAULT_COMPONENT_NAME program)  # what is of no other component: dev, and those of python/
include(cmake/shell.cmake)

install(TARGETS fjr EXPORT fjrTargets RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
install(TARGETS fjr_complete EXPORT fjrTargets RUNTIME DESTINATION ${CMAKE_INSTALL_LIBDIR}/fjr)  # where the first one finds it
install(PROGRAMS planner/program/fjr-batch-slurm DESTINATION ${CMAKE_INSTALL_BINDIR})
# The chain factorisation has the symbols of another library (planner/nlp/chain/ma27.h): a folder of its own keeps it
# from being linked by anybody else.
install(TARGETS fjr_folder fjr_kkt EXPORT fjrTargets LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/fjr)
set_target_properties(fjr PROPERTIES INSTALL_RPATH "$ORIGIN/../${CMAKE_INSTALL_LIBDIR}/fjr")
set_target_properties(fjr_complete PROPERTIES INSTALL_RPATH "$ORIGIN")
install(TARGETS fjr_common fjr_model fjr_planner
  EXPORT fjrTargets
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT dev
  LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}
  INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/fjr)
# What the Python package needs beside them: components of find_package(fjr), for they need more packages.
install(TARGETS fjr_identify fjr_idl fjr_report fjr_results fjr_service EXPORT fjrComponentTargets
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT dev
  INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/fjr)
install(DIRECTORY config/ DESTINATION ${CMAKE_INSTALL_DATADIR}/fjr/config USE_SOURCE_PERMISSIONS)
install(DIRECTORY idl/ DESTINATION ${CMAKE_INSTALL_DATADIR}/fjr/idl FILES_MATCHING PATTERN "*.idl")
# The units name the program and its configuration by their full paths, which are known when they are installed (--prefix).
# systemd looks in /usr/lib and /usr/local/lib; from elsewhere: `systemctl link`. The machine's own configuration is
# /etc/fjr (below the prefix where that is no system folder), and never overwritten.
install(CODE "
  set(FJR_BIN \"\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_BINDIR}\")
  set(FJR_DATA \"\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_DATADIR}\")
  set(FJR_ETC \"\${CMAKE_INSTALL_PREFIX}/etc\")
  if(CMAKE_INSTALL_PREFIX MATCHES \"^/(usr|usr/local|opt/.*)$\")
    set(FJR_ETC /etc)
  endif()
  file(READ \"${PROJECT_SOURCE_DIR}/cmake/confined.service.in\" FJR_CONFINED)
  string(STRIP \"\${FJR_CONFINED}\" FJR_CONFINED)
  foreach(unit fjr.service fjr-executor.service fjr-worker.service)
    configure_file(\"${PROJECT_SOURCE_DIR}/cmake/\${unit}.in\" \"${PROJECT_BINARY_DIR}/cmake/\${unit}\" @ONLY)
    file(INSTALL \"${PROJECT_BINARY_DIR}/cmake/\${unit}\" DESTINATION \"\${CMAKE_INSTALL_PREFIX}/lib/systemd/system\")
  endforeach()
  foreach(file service.yaml executor.yaml robot.yaml)
    if(NOT EXISTS \"\$ENV{DESTDIR}\${FJR_ETC}/fjr/\${file}\")
      file(INSTALL \"${PROJECT_SOURCE_DIR}/config/\${file}\" DESTINATION \"\${FJR_ETC}/fjr\")
    endif()
  endforeach()")
install(CODE "
  set(FJR_SOURCE \"${PROJECT_SOURCE_DIR}\")
  set(FJR_INCLUDE \"${CMAKE_INSTALL_INCLUDEDIR}/fjr\")
  include(\"${PROJECT_SOURCE_DIR}/cmake/install_headers.cmake\")" COMPONENT dev)

set(fjr_package ${CMAKE_INSTALL_LIBDIR}/cmake/fjr)
install(EXPORT fjrTargets NAMESPACE fjr:: DESTINATION ${fjr_package} COMPONENT dev)
install(EXPORT fjrComponentTargets NAMESPACE fjr:: DESTINATION ${fjr_package} COMPONENT dev)
configure_package_config_file(cmake/fjrConfig.cmake.in ${PROJECT_BINARY_DIR}/cmake/fjrConfig.cmake
  INSTALL_DESTINATION ${fjr_package} PATH_VARS CMAKE_INSTALL_DATADIR)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/cmake/fjrConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/cmake/fjrConfig.cmake ${PROJECT_BINARY_DIR}/cmake/fjrConfigVersion.cmake
  DESTINATION ${fjr_package} COMPONENT dev)
