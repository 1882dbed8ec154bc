// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Whether a value is worth a place in the cache.
///
/// A value is kept when making it again, together with everything unkept that it was made from, would take more than
/// twice as long as writing it. How fast writing is, is measured as values are written; until then 500 MB per second
/// are assumed.

#include "scanmill/data/array.hpp"

namespace scanmill {

class KeepRule {
public:
    enum class Policy { never, worth, always };

    explicit KeepRule(Policy policy = Policy::worth) : policy_(policy) {}

    bool is_worth(double seconds_to_make, u64 bytes) const {
        if (policy_ != Policy::worth) return policy_ == Policy::always;
        constexpr double margin = 2;
        return seconds_to_make > margin * static_cast<double>(bytes) / bytes_per_second_;
    }
    /// What writing a value took. Small ones say more about the file system's names than about its speed.
    void wrote(u64 bytes, double seconds) {
        constexpr u64 telling = 1 << 20;
        if (bytes < telling || !(seconds > 0)) return;
        written_ += static_cast<double>(bytes);
        seconds_ += seconds;
        bytes_per_second_ = written_ / seconds_;
    }
    double bytes_per_second() const { return bytes_per_second_; }

private:
    Policy policy_;
    double written_ = 0, seconds_ = 0;
    double bytes_per_second_ = 5e8;
};

}  // namespace scanmill
