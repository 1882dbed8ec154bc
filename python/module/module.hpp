// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The parts of the extension module `scanmill._native`. Python code of the package calls it; its users do not.

#include <nanobind/nanobind.h>

#include "scanmill/base/error.hpp"

namespace scanmill::python {

void add_values(nanobind::module_& module);
void add_filters(nanobind::module_& module);

/// The Python exception for the error: scanmill.Error.
nanobind::object exception_of(const Error& error);

}  // namespace scanmill::python
