// SPDX-License-Identifier: GPL-3.0-or-later
// The fuzzer of every target: SCANMILL_FUZZ_TARGET names the one that it feeds. With files as arguments it feeds those:
// SCANMILL_FUZZ_TARGET=ply build/fuzz/bin/scanmill-fuzz build/fuzz/findings/ply-crash-…
#include <cstdint>
#include <cstdio>
#include <cstdlib>

#include "fuzz/targets.hpp"

namespace {

const scanmill::test::FuzzTarget& chosen_target() {
    const char* const name = std::getenv("SCANMILL_FUZZ_TARGET");
    if (name) return scanmill::test::fuzz_target(name);
    std::fputs("error: SCANMILL_FUZZ_TARGET names no target\n", stderr);
    std::exit(2);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const scanmill::test::FuzzTarget& target = chosen_target();
    target.run({reinterpret_cast<const char*>(data), size});
    return 0;
}
