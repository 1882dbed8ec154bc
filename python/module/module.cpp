// SPDX-License-Identifier: GPL-3.0-or-later
#include "module.hpp"

namespace scanmill::python {

namespace nb = nanobind;

nb::object readable(const std::string& text) {
    return nb::bytes(text.data(), text.size()).attr("decode")("utf-8", "replace");
}

nb::list readable(const std::vector<std::string>& texts) {
    nb::list list;
    for (const std::string& text : texts) list.append(readable(text));
    return list;
}

nb::object exception_of(const Error& error) {
    return nb::module_::import_("scanmill._errors")
        .attr("Error")(readable(error.sentence()), readable(error.frames()), readable(error.hint()),
                       static_cast<int>(error.remedy()));
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
    nb::set_leak_warnings(false);  // threads that still run when the interpreter ends keep their values
    nb::register_exception_translator(translate);
    module.attr("version") = SCANMILL_VERSION;
    add_values(module);
    add_filters(module);
}

}  // namespace scanmill::python
