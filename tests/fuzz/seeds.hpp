// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Binary seeds, made by readable code.

#include <string>
#include <vector>

namespace scanmill::test {

struct Seed {
    std::string target;  ///< that it is for
    std::string file;
    std::string bytes;
};

std::vector<Seed> binary_seeds();

}  // namespace scanmill::test
