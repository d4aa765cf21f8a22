# `cmake --install` and find_package(resilin): targets resilin::<module> and resilin::resilin, which is all of them.

include(CMakePackageConfigHelpers)

get_property(RESILIN_INSTALLED_MODULES GLOBAL PROPERTY RESILIN_MODULES)

add_library(resilin_all INTERFACE)
add_library(resilin::resilin ALIAS resilin_all)
set_target_properties(resilin_all PROPERTIES EXPORT_NAME resilin)
target_link_libraries(resilin_all INTERFACE ${RESILIN_INSTALLED_MODULES})

# A static library's private dependencies must be found by whoever links it: the packages are read off the targets
# ("fmt::fmt" needs the package fmt), so that the list cannot go stale.
set(RESILIN_DEPENDENCIES)
foreach(module IN LISTS RESILIN_INSTALLED_MODULES)
  get_target_property(links ${module} INTERFACE_LINK_LIBRARIES)
  string(REGEX REPLACE "\\$<BUILD_INTERFACE:[^>]*>" "" links "${links}")  # headers that no installed header sees
  string(REGEX MATCHALL "[A-Za-z0-9_]+::" namespaces "${links}")
  list(APPEND RESILIN_DEPENDENCIES ${namespaces})
endforeach()
list(TRANSFORM RESILIN_DEPENDENCIES REPLACE "::$" "")
list(REMOVE_DUPLICATES RESILIN_DEPENDENCIES)
list(REMOVE_ITEM RESILIN_DEPENDENCIES resilin)
list(SORT RESILIN_DEPENDENCIES)
set(RESILIN_FIND_DEPENDENCIES)
foreach(dependency IN LISTS RESILIN_DEPENDENCIES)
  string(APPEND RESILIN_FIND_DEPENDENCIES "find_dependency(${dependency})\n")
endforeach()

set(RESILIN_PACKAGE_FOLDER ${CMAKE_INSTALL_LIBDIR}/cmake/resilin)
install(TARGETS ${RESILIN_INSTALLED_MODULES} resilin_all EXPORT resilinTargets
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(EXPORT resilinTargets NAMESPACE resilin:: DESTINATION ${RESILIN_PACKAGE_FOLDER})
install(DIRECTORY ${PROJECT_SOURCE_DIR}/src/resilin DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}
  FILES_MATCHING PATTERN "*.hpp")
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/resilinConfig.cmake.in
  ${PROJECT_BINARY_DIR}/resilinConfig.cmake INSTALL_DESTINATION ${RESILIN_PACKAGE_FOLDER})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/resilinConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/resilinConfig.cmake ${PROJECT_BINARY_DIR}/resilinConfigVersion.cmake
  DESTINATION ${RESILIN_PACKAGE_FOLDER})
if(TARGET resilin)
  install(TARGETS resilin RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
  # What it prints about itself goes where shells and man look for it.
  foreach(text "completion bash:bash-completion/completions/resilin" "completion zsh:zsh/site-functions/_resilin"
               "completion fish:fish/vendor_completions.d/resilin.fish" "info --man-page:man/man1/resilin.1")
    string(REPLACE ":" ";" text "${text}")
    list(GET text 0 arguments)
    list(GET text 1 file)
    get_filename_component(folder ${file} DIRECTORY)
    install(CODE "
      set(file \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_DATADIR}/${file}\")
      file(MAKE_DIRECTORY \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_DATADIR}/${folder}\")
      execute_process(COMMAND \"$<TARGET_FILE:resilin>\" ${arguments} OUTPUT_FILE \"\${file}\" RESULT_VARIABLE failed)
      if(failed)
        file(REMOVE \"\${file}\")
        message(WARNING \"resilin ${arguments} does not run on this machine: \${file} is left out\")
      else()
        message(STATUS \"Installing: \${file}\")
      endif()")
  endforeach()
endif()
if(TARGET resilin_bench)  # beside it, where it was built
  install(TARGETS resilin_bench RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} OPTIONAL)
endif()
install(FILES ${PROJECT_SOURCE_DIR}/build/wasm/apps/play/resilin_play.wasm DESTINATION ${CMAKE_INSTALL_DATADIR}/resilin
  OPTIONAL)  # what `resilin export` puts into pages, where it was built
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
