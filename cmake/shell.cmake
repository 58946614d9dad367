# What shells and `man` know of the program, made of what it says itself with --help. `cmake --install` takes what was
# built: `cmake --build build --target fjr_shell`.
set(fjr_shell ${PROJECT_BINARY_DIR}/shell)
find_program(HELP2MAN help2man)
if(HELP2MAN)
  add_custom_command(OUTPUT ${fjr_shell}/fjr ${fjr_shell}/man/fjr.1.gz
    COMMAND ${CMAKE_COMMAND} -E make_directory ${fjr_shell}
    COMMAND fjr_complete completion bash > ${fjr_shell}/fjr
    COMMAND ${CMAKE_CURRENT_LIST_DIR}/man_pages.sh $<TARGET_FILE:fjr_complete> ${fjr_shell}/man
    DEPENDS fjr_complete ${CMAKE_CURRENT_LIST_DIR}/man_pages.sh VERBATIM)
  add_custom_target(fjr_shell DEPENDS ${fjr_shell}/fjr)
endif()
install(FILES ${fjr_shell}/fjr DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions OPTIONAL)
install(DIRECTORY ${fjr_shell}/man/ DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 OPTIONAL)
