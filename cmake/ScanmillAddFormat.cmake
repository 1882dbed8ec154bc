# SPDX-License-Identifier: GPL-3.0-or-later
# scanmill_add_format(<folder> [LINK <target>…] [INCLUDE <folder>…])
#
# Builds the module scanmill-<folder>.so from every .cpp in formats/<folder>, and its manifest scanmill-<folder>.json, which
# the built module writes.
function(scanmill_add_format folder)
  cmake_parse_arguments(FORMAT "" "" "LINK;INCLUDE" ${ARGN})
  if(FORMAT_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "scanmill_add_format(${folder}): unknown arguments ${FORMAT_UNPARSED_ARGUMENTS}")
  endif()
  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${folder}/*.cpp)
  set(module scanmill-format-${folder})
  add_library(${module} MODULE ${sources})
  set_target_properties(
    ${module}
    PROPERTIES PREFIX ""
               OUTPUT_NAME scanmill-${folder}
               CXX_VISIBILITY_PRESET hidden
               VISIBILITY_INLINES_HIDDEN ON
               INSTALL_RPATH "\$ORIGIN/../.."
               BUILD_WITH_INSTALL_RPATH ON
               INSTALL_RPATH_USE_LINK_PATH ON
               LIBRARY_OUTPUT_DIRECTORY ${SCANMILL_FORMAT_OUTPUT_DIRECTORY})
  target_compile_definitions(${module} PRIVATE SCANMILL_FORMAT_NAME="${folder}" ${SCANMILL_HEADERS_DEFINITION})
  target_include_directories(${module} PRIVATE ${CMAKE_CURRENT_SOURCE_DIR})
  target_include_directories(${module} SYSTEM PRIVATE ${FORMAT_INCLUDE})
  target_link_libraries(${module} PRIVATE Scanmill::core ${FORMAT_LINK})
  target_link_options(${module} PRIVATE LINKER:--exclude-libs,ALL)
  if(TARGET scanmill-warnings)
    target_link_libraries(${module} PRIVATE $<BUILD_INTERFACE:scanmill-warnings>)
  endif()
  set(manifest ${SCANMILL_FORMAT_OUTPUT_DIRECTORY}/scanmill-${folder}.json)
  add_custom_command(
    TARGET ${module}
    POST_BUILD
    COMMAND scanmill-manifest --format $<TARGET_FILE:${module}> ${manifest}
    COMMENT "Writing the manifest of the format ${folder}"
    VERBATIM)
  add_dependencies(${module} scanmill-manifest)
  install(TARGETS ${module} LIBRARY DESTINATION ${SCANMILL_INSTALL_FORMAT_DIR})
  install(FILES ${manifest} DESTINATION ${SCANMILL_INSTALL_FORMAT_DIR})
endfunction()
