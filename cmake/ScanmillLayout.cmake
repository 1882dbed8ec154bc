# SPDX-License-Identifier: GPL-3.0-or-later
# The build tree has the layout of the installed tree, so the program finds its modules in both in the same way:
# bin/scanmill, lib/libscanmill-*.so, lib/scanmill/plugins/scanmill-<filter>.so with its manifest beside it.
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bin)
set(CMAKE_LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/lib)
set(CMAKE_ARCHIVE_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/lib)
set(SCANMILL_PLUGIN_SUBDIR scanmill/plugins)
set(SCANMILL_PLUGIN_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/lib/${SCANMILL_PLUGIN_SUBDIR})
# The plugin folder relative to the folder of libscanmill-core.so is equal in both trees.
set(SCANMILL_INSTALL_PLUGIN_DIR ${CMAKE_INSTALL_LIBDIR}/${SCANMILL_PLUGIN_SUBDIR})
# The folder of format modules is beside that of filter modules.
set(SCANMILL_FORMAT_SUBDIR scanmill/formats)
set(SCANMILL_FORMAT_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/lib/${SCANMILL_FORMAT_SUBDIR})
set(SCANMILL_INSTALL_FORMAT_DIR ${CMAKE_INSTALL_LIBDIR}/${SCANMILL_FORMAT_SUBDIR})

# Programs search for their libraries only in the library folders beside their own folder. CMake's default run path in the
# build tree would include the working folder.
set(SCANMILL_PROGRAM_RPATH "\$ORIGIN/../${CMAKE_INSTALL_LIBDIR}" "\$ORIGIN/../lib")
list(REMOVE_DUPLICATES SCANMILL_PROGRAM_RPATH)
