# SPDX-License-Identifier: GPL-3.0-or-later
# scanmill_add_filter(<folder> [LINK <target>…] [DEFINE <macro>…] [NO_INSTALL])
#
# Builds a filter from filters/<folder>. <name> is the folder's name with hyphens.
#   scanmill-<name>-algorithm   a static library of every .cpp except plugin.cpp: the plain functions, for tests and programs
#   scanmill-<name>.so          the module, from plugin.cpp
#   scanmill-<name>.json        the manifest, written by the built module
# The configuration fails if the filter has no README.md or no test file: tests/filters/<folder>*_test.cpp or
# tests/filters/<folder>/*_test.cpp. Set SCANMILL_FILTER_TESTS if the tests are in another folder. NO_INSTALL is for modules that only tests use.
function(scanmill_add_filter folder)
  cmake_parse_arguments(FILTER "NO_INSTALL" "" "LINK;DEFINE" ${ARGN})
  if(FILTER_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "scanmill_add_filter(${folder}): unknown arguments ${FILTER_UNPARSED_ARGUMENTS}")
  endif()
  string(REPLACE "_" "-" name ${folder})
  set(source ${CMAKE_CURRENT_SOURCE_DIR}/${folder})

  if(NOT EXISTS ${source}/README.md)
    message(FATAL_ERROR "filter ${name}: ${source}/README.md is missing; every filter needs a page")
  endif()
  if(NOT SCANMILL_FILTER_TESTS)
    set(SCANMILL_FILTER_TESTS ${PROJECT_SOURCE_DIR}/tests/filters)
  endif()
  file(GLOB tests CONFIGURE_DEPENDS ${SCANMILL_FILTER_TESTS}/${folder}*_test.cpp
       ${SCANMILL_FILTER_TESTS}/${folder}/*_test.cpp)
  if(NOT tests)
    message(FATAL_ERROR "filter ${name}: no ${SCANMILL_FILTER_TESTS}/${folder}_test.cpp; every filter needs tests")
  endif()

  file(GLOB sources CONFIGURE_DEPENDS ${source}/*.cpp)
  list(REMOVE_ITEM sources ${source}/plugin.cpp)
  add_library(scanmill-${name}-algorithm STATIC ${sources})
  set_target_properties(scanmill-${name}-algorithm PROPERTIES CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON
                                                              POSITION_INDEPENDENT_CODE ON)
  target_include_directories(scanmill-${name}-algorithm PUBLIC ${source}/..)
  target_compile_definitions(scanmill-${name}-algorithm PRIVATE ${FILTER_DEFINE})
  # No fused multiply-add, so that results have the same bytes on every processor.
  target_compile_options(scanmill-${name}-algorithm PUBLIC -ffp-contract=off)
  target_link_libraries(scanmill-${name}-algorithm PUBLIC Scanmill::core Scanmill::geometry PRIVATE ${FILTER_LINK})
  if(TARGET scanmill-warnings)
    target_link_libraries(scanmill-${name}-algorithm PRIVATE $<BUILD_INTERFACE:scanmill-warnings>)
  endif()

  add_library(scanmill-${name} MODULE ${source}/plugin.cpp)
  set_target_properties(
    scanmill-${name}
    PROPERTIES PREFIX ""
               CXX_VISIBILITY_PRESET hidden
               VISIBILITY_INLINES_HIDDEN ON
               INSTALL_RPATH "\$ORIGIN/../.."
               BUILD_WITH_INSTALL_RPATH ON
               INSTALL_RPATH_USE_LINK_PATH ON
               LIBRARY_OUTPUT_DIRECTORY ${SCANMILL_PLUGIN_OUTPUT_DIRECTORY})
  target_compile_definitions(scanmill-${name} PRIVATE SCANMILL_FILTER_NAME="${name}" ${SCANMILL_HEADERS_DEFINITION})
  target_link_libraries(scanmill-${name} PRIVATE scanmill-${name}-algorithm)
  target_link_options(scanmill-${name} PRIVATE LINKER:--exclude-libs,ALL)
  if(TARGET scanmill-warnings)
    target_link_libraries(scanmill-${name} PRIVATE $<BUILD_INTERFACE:scanmill-warnings>)
  endif()

  add_custom_command(
    TARGET scanmill-${name}
    POST_BUILD
    COMMAND Scanmill::manifest $<TARGET_FILE:scanmill-${name}> ${SCANMILL_PLUGIN_OUTPUT_DIRECTORY}/scanmill-${name}.json
    COMMENT "Writing the manifest of ${name}"
    VERBATIM)
  add_dependencies(scanmill-${name} Scanmill::manifest)

  if(NOT FILTER_NO_INSTALL)
    set_property(GLOBAL APPEND PROPERTY SCANMILL_MODULES scanmill-${name})
    install(TARGETS scanmill-${name} LIBRARY DESTINATION ${SCANMILL_INSTALL_PLUGIN_DIR})
    install(FILES ${SCANMILL_PLUGIN_OUTPUT_DIRECTORY}/scanmill-${name}.json DESTINATION ${SCANMILL_INSTALL_PLUGIN_DIR})
  endif()
endfunction()
