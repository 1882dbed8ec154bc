// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The parts of the extension module `scanmill._native`. Python code of the package calls it; its users do not.

#include <nanobind/nanobind.h>

#include <string>
#include <vector>

#include "scanmill/base/error.hpp"

namespace scanmill::python {

void add_values(nanobind::module_& module);
void add_filters(nanobind::module_& module);

/// The text as Python has it. Bytes that are not UTF-8, as names of files may have, are replaced.
nanobind::object readable(const std::string& text);
nanobind::list readable(const std::vector<std::string>& texts);

/// The Python exception for the error: scanmill.Error.
nanobind::object exception_of(const Error& error);

}  // namespace scanmill::python
