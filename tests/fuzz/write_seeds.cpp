// SPDX-License-Identifier: GPL-3.0-or-later
// write_seeds FOLDER: puts the seeds that are made by code into FOLDER/<target>/.
#include <filesystem>
#include <fstream>
#include <iostream>

#include "fuzz/seeds.hpp"

int main(int count, char** arguments) {
    if (count != 2) {
        std::cerr << "usage: write_seeds FOLDER\n";
        return 2;
    }
    for (const auto& [target, file, bytes] : scanmill::test::binary_seeds()) {
        const std::filesystem::path folder = std::filesystem::path(arguments[1]) / target;
        std::filesystem::create_directories(folder);
        std::ofstream(folder / file, std::ios::binary) << bytes;
    }
}
