// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Lists of elements, stored one after another.

#include <numeric>
#include <span>

#include "scanmill/data/array.hpp"

namespace scanmill {

template <class Element = u32>
class Lists {
public:
    Lists() = default;
    /// `each(add)` calls add(list, element) for every element; `list` is below `count`. `each` is called twice and must
    /// report the same elements in the same order. The elements of each list keep this order. Cost: linear.
    template <class Each>
    Lists(std::size_t count, const Each& each) : begin_(count + 1, 0) {
        each([&](std::size_t list, const Element&) { ++begin_[list + 1]; });
        std::inclusive_scan(begin_.begin(), begin_.end(), begin_.begin());
        elements_.resize(begin_.back());
        Array<std::size_t> next(begin_.begin(), begin_.end() - 1);
        each([&](std::size_t list, const Element& element) { elements_[next[list]++] = element; });
    }

    std::span<const Element> operator[](std::size_t list) const {
        return std::span(elements_).subspan(begin_[list], begin_[list + 1] - begin_[list]);
    }
    std::span<Element> operator[](std::size_t list) {
        return std::span(elements_).subspan(begin_[list], begin_[list + 1] - begin_[list]);
    }
    bool empty() const { return begin_.empty(); }
    /// The elements of all lists.
    std::span<const Element> elements() const { return elements_; }

private:
    Array<std::size_t> begin_;
    Array<Element> elements_;
};

}  // namespace scanmill
