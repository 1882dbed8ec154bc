// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// A sum that keeps the digits that additions lose (Neumaier 1974): its error does not grow with the number of terms.

#include <cmath>

namespace scanmill::measuring {

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

}  // namespace scanmill::measuring
