// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The seeds that are no text: made here rather than kept as bytes that nobody can read.

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
