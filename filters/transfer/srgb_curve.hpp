// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The transfer curve of sRGB, between stored codes and linear light, with bits that do not depend on the processor.
///
/// Source: IEC 61966-2-1.

#include "scanmill/data/array.hpp"

namespace scanmill::transferring {

class SrgbCurve {
public:
    /// `levels`: the number of codes; 256 for bytes.
    explicit SrgbCurve(u32 levels);

    /// The linear light of a code, from 0 to 1.
    double linear(u32 code) const { return linear_[code]; }
    /// The nearest code, measured along the curve; halfway between two codes the higher one. code(linear(c)) == c.
    u32 code(double linear) const;

private:
    Array<double> linear_;  // by code
    Array<double> limits_;  // [c] is halfway between the codes c and c + 1
};

}  // namespace scanmill::transferring
