// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Whether arrays, and values that consist of them, are equal to the last bit.

#include <gtest/gtest.h>

#include <algorithm>
#include <span>

#include "scanmill/data/patches.hpp"

namespace scanmill::test {

template <class T>
bool same_bits(const Buffer<T>& a, const Buffer<T>& b) {
    return std::ranges::equal(std::as_bytes(a.span()), std::as_bytes(b.span()));
}

inline void expect_same_bits(const PatchComplex& a, const PatchComplex& b) {
    EXPECT_EQ(a.frame, b.frame);
    EXPECT_TRUE(same_bits(a.positions, b.positions));
    EXPECT_TRUE(same_bits(a.tets, b.tets));
    EXPECT_TRUE(same_bits(a.weights, b.weights));
    EXPECT_TRUE(same_bits(a.kinds, b.kinds));
    EXPECT_TRUE(same_bits(a.sides, b.sides));
    EXPECT_TRUE(same_bits(a.triangles, b.triangles));
    EXPECT_TRUE(same_bits(a.edges, b.edges));
    EXPECT_TRUE(same_bits(a.combine, b.combine));
    EXPECT_TRUE(same_bits(a.partners, b.partners));
}

}  // namespace scanmill::test
