# SPDX-License-Identifier: GPL-3.0-or-later
# The build tree is laid out as the installed one, so that the program finds its modules in both the same way:
# bin/scanmill, lib/libscanmill-*.so, lib/scanmill/plugins/scanmill-<filter>.so with its manifest beside it.
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bin)
set(CMAKE_LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/lib)
set(CMAKE_ARCHIVE_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/lib)
set(SCANMILL_PLUGIN_SUBDIR scanmill/plugins)
set(SCANMILL_PLUGIN_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/lib/${SCANMILL_PLUGIN_SUBDIR})
# The same place seen from the folder that holds libscanmill-core.so, in both trees.
set(SCANMILL_INSTALL_PLUGIN_DIR ${CMAKE_INSTALL_LIBDIR}/${SCANMILL_PLUGIN_SUBDIR})
# Modules of file formats lie beside those of filters.
set(SCANMILL_FORMAT_SUBDIR scanmill/formats)
set(SCANMILL_FORMAT_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/lib/${SCANMILL_FORMAT_SUBDIR})
set(SCANMILL_INSTALL_FORMAT_DIR ${CMAKE_INSTALL_LIBDIR}/${SCANMILL_FORMAT_SUBDIR})

# Programs look for their libraries in both trees' folder beside their own, and nowhere else: the build tree's run path
# as CMake fills it up would make the working folder count.
set(SCANMILL_PROGRAM_RPATH "\$ORIGIN/../${CMAKE_INSTALL_LIBDIR}" "\$ORIGIN/../lib")
list(REMOVE_DUPLICATES SCANMILL_PROGRAM_RPATH)
