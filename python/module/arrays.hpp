// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// NumPy arrays of the memory of values, and values of the memory of NumPy arrays. Neither copies an element.

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <array>
#include <memory>
#include <string>
#include <type_traits>
#include <vector>

#include "scanmill/data/columns.hpp"
#include "scanmill/data/frame.hpp"

namespace scanmill::python {

namespace nb = nanobind;

/// An array as the Python part passes it: row by row, aligned, of a type that the callee expects.
using GivenArray = nb::ndarray<nb::ro, nb::c_contig, nb::device::cpu>;

/// A read-only array that views the memory and keeps its owner.
nb::object numpy_array(std::shared_ptr<const void> owner, const void* data, const std::vector<std::size_t>& shape,
                       nb::dlpack::dtype type);

nb::dlpack::dtype numpy_type(ScalarType type);
/// Throws TypeError for a type that columns cannot have.
ScalarType scalar_type(const GivenArray& array);

/// The scalars of one element of a buffer.
template <class T>
struct Element {
    using Scalar = T;
    static constexpr std::size_t count = 1;
};
template <>
struct Element<Vec3> {
    using Scalar = double;
    static constexpr std::size_t count = 3;
};
template <class T, std::size_t n>
struct Element<std::array<T, n>> {
    using Scalar = T;
    static constexpr std::size_t count = n;
};

/// #elements, or #elements × scalars of one element.
template <class T>
nb::object numpy_array(const Buffer<T>& buffer) {
    using Scalar = typename Element<T>::Scalar;
    std::vector<std::size_t> shape{buffer.size()};
    if (Element<T>::count > 1) shape.push_back(Element<T>::count);
    if constexpr (std::is_enum_v<Scalar>)
        return numpy_array(buffer.owner(), buffer.data(), shape, nb::dtype<std::underlying_type_t<Scalar>>());
    else
        return numpy_array(buffer.owner(), buffer.data(), shape, nb::dtype<Scalar>());
}

/// A dict of the columns: name to array. A column of lists is a pair: offsets and numbers.
nb::dict numpy_columns(const ColumnTable& columns);

/// The array's memory as an owner, which any thread may release.
std::shared_ptr<const void> owner_of(const GivenArray& array);

/// Views the array. Throws TypeError if its type or its shape is not that of a buffer of T.
template <class T>
Buffer<T> buffer_of(const GivenArray& array, const char* name) {
    using Scalar = typename Element<T>::Scalar;
    constexpr std::size_t count = Element<T>::count;
    const bool has_shape = count > 1 ? array.ndim() == 2 && array.shape(1) == count : array.ndim() == 1;
    if (!has_shape || array.dtype() != nb::dtype<Scalar>())
        throw nb::type_error((std::string(name) + " has the wrong type or shape").c_str());
    return {owner_of(array), static_cast<const T*>(static_cast<const void*>(array.data())), array.shape(0)};
}

/// A column that views the array: #rows, or #rows × components. Its numbers are no lengths, so no change of unit scales
/// them.
Column column_of(const std::string& name, const GivenArray& array);

}  // namespace scanmill::python
