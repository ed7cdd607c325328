# cmake --install: the program, its manual pages and completions, its pages, and what is to be read.
include(GNUInstallDirs)
install(TARGETS aerate RUNTIME DESTINATION "${CMAKE_INSTALL_BINDIR}")
install(FILES README.md LICENSE CHANGELOG.md CONTRIBUTING.md DESTINATION "${CMAKE_INSTALL_DOCDIR}")
install(DIRECTORY docs DESTINATION "${CMAKE_INSTALL_DOCDIR}")

# Made from the program's options (src/cli/write_command_files.cpp). bash, zsh and fish look there.
install(DIRECTORY "${aerate_command_files}/man1" DESTINATION "${CMAKE_INSTALL_MANDIR}")
install(DIRECTORY "${aerate_command_files}/bash/" DESTINATION "${CMAKE_INSTALL_DATADIR}/bash-completion/completions")
install(DIRECTORY "${aerate_command_files}/zsh/" DESTINATION "${CMAKE_INSTALL_DATADIR}/zsh/site-functions")
install(DIRECTORY "${aerate_command_files}/fish/" DESTINATION "${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d")

# For who builds without node (AERATE_VIEW_PAGE).
if(aerate_built_files)
  install(FILES ${aerate_built_files} DESTINATION "${CMAKE_INSTALL_DATADIR}/aerate")
endif()
# Where the studio is part of the program, an entry in the menus of desktops opens it.
if(aerate_built_files MATCHES "/studio\\.html(;|$)")
  install(FILES packaging/aerate-studio.desktop DESTINATION "${CMAKE_INSTALL_DATADIR}/applications")
  install(FILES packaging/aerate.svg DESTINATION "${CMAKE_INSTALL_DATADIR}/icons/hicolor/scalable/apps")
endif()
