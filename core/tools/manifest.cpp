// SPDX-License-Identifier: GPL-3.0-or-later
/// scanmill-manifest [--format] MODULE MANIFEST: loads a just-built module of a filter (or of a file format), checks
/// its declaration and writes its manifest.

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <vector>

#include "scanmill/base/error.hpp"
#include "scanmill/plugin/format_modules.hpp"
#include "scanmill/plugin/manifest.hpp"
#include "scanmill/plugin/module.hpp"

using namespace scanmill;

static std::string manifest_of(const std::filesystem::path& module, bool is_format) {
    const std::string name = module_name(module);
    if (is_format) return to_json_text(FormatManifest{abi_text(), load_format_module(module, name).spec});
    const FilterDeclaration declaration = load_module(module, name);
    require_sound(declaration.spec);
    return to_json_text(Manifest{abi_text(), declaration.spec});
}

int main(int argc, char** argv) {
    std::vector<std::string> arguments(argv + 1, argv + argc);
    const bool is_format = !arguments.empty() && arguments.front() == "--format";
    if (is_format) arguments.erase(arguments.begin());
    if (arguments.size() != 2) {
        std::fputs("usage: scanmill-manifest [--format] MODULE MANIFEST\n", stderr);
        return 2;
    }
    try {
        const std::string text = manifest_of(std::filesystem::absolute(arguments[0]), is_format);
        std::ofstream file(arguments[1], std::ios::binary | std::ios::trunc);
        file << text;
        file.close();
        if (!file) throw Error("'{}' cannot be written", arguments[1]);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "error: %s\n", error.what());
        return 1;
    }
}
