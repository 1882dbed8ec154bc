# SPDX-License-Identifier: GPL-3.0-or-later
# What every target is compiled with. Tuning flags stay in the presets; these two decide whether results are right:
# no fused multiply-add behind our back (same bytes on every processor), and sanitizers in all or in none.
find_program(CCACHE ccache)
if(CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CCACHE})
endif()

add_compile_options(-ffp-contract=off)
if(SCANMILL_SANITIZE)
  add_compile_options(-fsanitize=${SCANMILL_SANITIZE} -fno-omit-frame-pointer)
  add_link_options(-fsanitize=${SCANMILL_SANITIZE})
  if(SCANMILL_SANITIZE MATCHES undefined)
    add_compile_options(-fno-sanitize-recover=undefined)
  endif()
endif()

add_library(scanmill-warnings INTERFACE)
target_compile_options(scanmill-warnings INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor
                                                   -Wno-restrict)  # false on "literal" + std::string with GCC 12
if(SCANMILL_SANITIZE)
  target_compile_options(scanmill-warnings INTERFACE -Wno-maybe-uninitialized)  # false with instrumentation
endif()
if(SCANMILL_WERROR)
  target_compile_options(scanmill-warnings INTERFACE -Werror)
endif()
