// SPDX-License-Identifier: GPL-3.0-or-later
#include "arrays.hpp"

namespace scanmill::python {

nb::object numpy_array(std::shared_ptr<const void> owner, const void* data, const std::vector<std::size_t>& shape,
                       nb::dlpack::dtype type) {
    static const double nothing = 0;  // an empty buffer may have no memory
    auto* kept = new std::shared_ptr<const void>(std::move(owner));
    const nb::capsule keeper(kept,
                             [](void* owned) noexcept { delete static_cast<std::shared_ptr<const void>*>(owned); });
    return nb::cast(nb::ndarray<nb::numpy, nb::ro>(data ? data : &nothing, shape.size(), shape.data(), keeper, nullptr,
                                                   type, nb::device::cpu::value));
}

nb::dlpack::dtype numpy_type(ScalarType type) {
    return visit_scalar(type, [](auto number) { return nb::dtype<decltype(number)>(); });
}

ScalarType scalar_type(const GivenArray& array) {
    for (int type = 0; type <= static_cast<int>(ScalarType::float64); ++type)
        if (array.dtype() == numpy_type(static_cast<ScalarType>(type))) return static_cast<ScalarType>(type);
    throw nb::type_error("a column holds integers or floating-point numbers of at most 64 bits");
}

nb::dict numpy_columns(const ColumnTable& columns) {
    nb::dict arrays;
    for (const Column& column : columns) {
        const Buffer<std::byte>& bytes = column.bytes();
        std::vector<std::size_t> shape{column.rows()};
        if (column.components() > 1) shape.push_back(column.components());
        if (column.is_list()) shape = {bytes.size() / size_of(column.type())};
        nb::object numbers = numpy_array(bytes.owner(), bytes.data(), shape, numpy_type(column.type()));
        arrays[column.name().c_str()] =
            column.is_list() ? nb::object(nb::make_tuple(numpy_array(column.offsets()), numbers)) : numbers;
    }
    return arrays;
}

std::shared_ptr<const void> owner_of(const GivenArray& array) {
    return std::shared_ptr<const GivenArray>(new GivenArray(array), [](const GivenArray* kept) {
        if (!nb::is_alive()) return;  // the interpreter has ended, and with it the array
        const nb::gil_scoped_acquire locked;
        delete kept;
    });
}

Column column_of(const std::string& name, const GivenArray& array) {
    if (array.ndim() != 1 && array.ndim() != 2)
        throw nb::type_error(("the column '" + name + "' has the wrong shape").c_str());
    const auto components = static_cast<u32>(array.ndim() == 2 ? array.shape(1) : 1);
    if (components == 0) throw nb::type_error(("the column '" + name + "' has no numbers").c_str());
    const Buffer<std::byte> bytes(
        owner_of(array), static_cast<const std::byte*>(static_cast<const void*>(array.data())), array.nbytes());
    return Column(name, scalar_type(array), components, bytes, {});
}

}  // namespace scanmill::python
