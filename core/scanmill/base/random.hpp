// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// A small seeded generator of random numbers: SplitMix64 (Steele, Lea, Flood 2014). Its numbers are the same on every
/// machine.
///
/// Parallel work takes a cheap stream per chunk or per item (random.stream(i)) and shares no state. The numbers then do
/// not depend on the number of threads.

#include <cmath>
#include <cstdint>

#include "scanmill/base/elementary.hpp"

namespace scanmill {

class Random {
public:
    explicit Random(std::uint64_t seed) : state_(seed) {}

    /// An independent generator for item `index`. Does not advance this generator.
    Random stream(std::uint64_t index) const {
        Random child(state_ ^ mix(index + 0x9e3779b97f4a7c15u));
        return Random(child.next());
    }
    std::uint64_t next() { return mix(state_ += 0x9e3779b97f4a7c15u); }
    /// Uniform in [0, 1), 53 bits.
    double uniform() { return static_cast<double>(next() >> 11) * 0x1p-53; }
    double uniform(double low, double high) { return low + (high - low) * uniform(); }
    /// Uniform in [0, count). Pre: count > 0. Bias below 2^-32 for counts below 2^32.
    std::uint64_t index(std::uint64_t count) {
        __extension__ using Wide = unsigned __int128;
        return static_cast<std::uint64_t>((static_cast<Wide>(next()) * count) >> 64);
    }
    /// A standard normal number by Marsaglia and Bray's polar method. The second number of each pair is discarded.
    double normal() {
        for (;;) {
            const double x = uniform(-1, 1), y = uniform(-1, 1);
            const double square = x * x + y * y;
            if (square > 0 && square < 1) return x * std::sqrt(-2 * elementary::log(square) / square);
        }
    }

private:
    static std::uint64_t mix(std::uint64_t z) {
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
        return z ^ (z >> 31);
    }
    std::uint64_t state_;
};

}  // namespace scanmill
