// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Sums of many distances.

#include <cmath>

namespace scanmill {

/// A sum that keeps the digits that additions lose (Neumaier 1974), so its error does not grow with the number of
/// terms. The result depends on the order of the terms.
class CompensatedSum {
public:
    void add(double term) {
        const double next = sum_ + term;
        lost_ += std::abs(sum_) >= std::abs(term) ? (sum_ - next) + term : (term - next) + sum_;
        sum_ = next;
    }
    double value() const { return sum_ + lost_; }

private:
    double sum_ = 0, lost_ = 0;
};

}  // namespace scanmill
