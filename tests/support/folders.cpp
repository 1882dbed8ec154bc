// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/folders.hpp"

#include <filesystem>
#include <fstream>
#include <stdexcept>

namespace scanmill::test {

namespace {

std::string read_source_folder() {
    const std::string file = build_folder() + "/source-folder.txt";
    std::string folder;
    if (!std::getline(std::ifstream(file), folder)) throw std::runtime_error("cannot read " + file);
    return folder;
}

}  // namespace

const std::string& build_folder() {
    static const std::string folder =
        std::filesystem::read_symlink("/proc/self/exe").parent_path().parent_path().string();
    return folder;
}

const std::string& source_folder() {
    static const std::string folder = read_source_folder();
    return folder;
}

std::string shipped(const std::string& name) { return source_folder() + "/workflows/" + name; }

const std::string& program_file() {
    static const std::string file = build_folder() + "/bin/scanmill";
    return file;
}

const std::string& plugin_folder() {
    static const std::string folder = build_folder() + "/lib/scanmill/plugins";
    return folder;
}

const std::string& test_plugin_folder() {
    static const std::string folder = build_folder() + "/lib/scanmill/test-plugins";
    return folder;
}

}  // namespace scanmill::test
