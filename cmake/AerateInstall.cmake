include(GNUInstallDirs)
install(TARGETS aerate RUNTIME DESTINATION "${CMAKE_INSTALL_BINDIR}")
install(FILES README.md LICENSE CHANGELOG.md DESTINATION "${CMAKE_INSTALL_DOCDIR}")
# For who builds without node (AERATE_VIEW_PAGE).
if(aerate_built_files)
  install(FILES ${aerate_built_files} DESTINATION "${CMAKE_INSTALL_DATADIR}/aerate")
endif()
