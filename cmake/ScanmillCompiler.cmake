# SPDX-License-Identifier: GPL-3.0-or-later
# Compiler flags of every target. Tuning flags are in the presets. The flags here affect correctness: no fused
# multiply-add (same bytes on every processor), and sanitizers in all targets or in none.
#
# Object files contain no path of the machine: the compiler cache serves every checkout, and equal sources give equal
# files. Tests find their folders at run time.
find_program(CCACHE ccache)
if(CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  set(CMAKE_CXX_COMPILER_LAUNCHER env CCACHE_BASEDIR=${PROJECT_SOURCE_DIR} CCACHE_NOHASHDIR=1 ${CCACHE})
endif()
add_compile_options(-ffile-prefix-map=${PROJECT_SOURCE_DIR}=.)

add_compile_options(-ffp-contract=off)
if(SCANMILL_SANITIZE)
  add_compile_options(-fsanitize=${SCANMILL_SANITIZE} -fno-omit-frame-pointer)
  add_link_options(-fsanitize=${SCANMILL_SANITIZE})
  if(SCANMILL_SANITIZE MATCHES undefined)
    add_compile_options(-fno-sanitize-recover=all)
  endif()
endif()
if(SCANMILL_FUZZ)
  if(NOT CMAKE_CXX_COMPILER_ID STREQUAL Clang)
    message(FATAL_ERROR "SCANMILL_FUZZ needs clang; the compiler is ${CMAKE_CXX_COMPILER_ID}. Use `make fuzz`, or "
                        "`tools/deps.sh fuzz` and `cmake --preset fuzz`")
  endif()
  # In every target, so that the fuzzer measures coverage everywhere.
  add_compile_options(-fsanitize=fuzzer-no-link)
endif()

add_library(scanmill-warnings INTERFACE)
target_compile_options(scanmill-warnings INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor)
if(CMAKE_CXX_COMPILER_ID STREQUAL GNU)
  target_compile_options(scanmill-warnings INTERFACE -Wno-restrict)  # false positive on "literal" + std::string with GCC 12
endif()
if(SCANMILL_SANITIZE AND CMAKE_CXX_COMPILER_ID STREQUAL GNU)
  target_compile_options(scanmill-warnings INTERFACE -Wno-maybe-uninitialized)  # false positives with instrumentation
endif()
if(SCANMILL_WERROR)
  target_compile_options(scanmill-warnings INTERFACE -Werror)
endif()
