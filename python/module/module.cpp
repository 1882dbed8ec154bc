// SPDX-License-Identifier: GPL-3.0-or-later
#include "module.hpp"

#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

namespace scanmill::python {

namespace nb = nanobind;

nb::object exception_of(const Error& error) {
    return nb::module_::import_("scanmill._errors")
        .attr("Error")(error.sentence(), error.frames(), error.hint(), static_cast<int>(error.remedy()));
}

namespace {

void translate(const std::exception_ptr& thrown, void*) {
    try {
        std::rethrow_exception(thrown);
    } catch (const Error& error) {
        const nb::object exception = exception_of(error);
        PyErr_SetObject(reinterpret_cast<PyObject*>(Py_TYPE(exception.ptr())), exception.ptr());
    }
}

}  // namespace

NB_MODULE(_native, module) {
    nb::register_exception_translator(translate);
    module.attr("version") = SCANMILL_VERSION;
    add_values(module);
    add_filters(module);
}

}  // namespace scanmill::python
