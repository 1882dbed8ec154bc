// SPDX-License-Identifier: GPL-3.0-or-later
/// scanmill-manifest [--format] MODULE MANIFEST: loads a just-built module of a filter (or of a file format), checks
/// its declaration and writes its manifest.

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <vector>

#include "scanmill/base/error.hpp"
#include "scanmill/filter/manifest.hpp"
#include "scanmill/plugin/format_modules.hpp"
#include "scanmill/plugin/module.hpp"

namespace {

std::string filter_manifest(const std::filesystem::path& module, const std::string& name) {
    const scanmill::FilterDeclaration declaration = scanmill::load_module(module, name);
    scanmill::require_sound(declaration.spec);
    return to_json_text(scanmill::Manifest{scanmill::abi_text(), declaration.spec});
}

std::string format_manifest(const std::filesystem::path& module, const std::string& name) {
    return to_json_text(
        scanmill::FormatManifest{scanmill::abi_text(), scanmill::load_format_module(module, name).spec});
}

}  // namespace

int main(int argc, char** argv) {
    std::vector<std::string> arguments(argv + 1, argv + argc);
    const bool is_format = !arguments.empty() && arguments.front() == "--format";
    if (is_format) arguments.erase(arguments.begin());
    if (arguments.size() != 2) {
        std::fputs("usage: scanmill-manifest [--format] MODULE MANIFEST\n", stderr);
        return 2;
    }
    const std::filesystem::path module = std::filesystem::absolute(arguments[0]);
    try {
        const std::string name = scanmill::module_name(module);
        const std::string text = is_format ? format_manifest(module, name) : filter_manifest(module, name);
        std::ofstream file(arguments[1], std::ios::binary | std::ios::trunc);
        file << text;
        file.close();
        if (!file) throw scanmill::Error("'{}' cannot be written", arguments[1]);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "error: %s\n", error.what());
        return 1;
    }
}
