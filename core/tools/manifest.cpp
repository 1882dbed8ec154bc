// SPDX-License-Identifier: GPL-3.0-or-later
/// scanmill-manifest MODULE MANIFEST: loads a just-built module, checks its declaration and writes its manifest.

#include <cstdio>
#include <filesystem>
#include <fstream>

#include "scanmill/filter/error.hpp"
#include "scanmill/filter/manifest.hpp"
#include "scanmill/filter/module.hpp"

int main(int argc, char** argv) {
    if (argc != 3) {
        std::fputs("usage: scanmill-manifest MODULE MANIFEST\n", stderr);
        return 2;
    }
    const std::filesystem::path module = argv[1];
    try {
        const std::string name = module.stem().string().substr(std::string_view("scanmill-").size());
        const scanmill::FilterDeclaration declaration = scanmill::load_module(std::filesystem::absolute(module), name);
        scanmill::require_sound(declaration.spec);
        std::ofstream file(argv[2], std::ios::binary | std::ios::trunc);
        file << scanmill::to_json_text({scanmill::abi_text(), declaration.spec});
        file.close();
        if (!file) throw scanmill::Error("'{}' cannot be written", argv[2]);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "error: %s\n", error.what());
        return 1;
    }
}
