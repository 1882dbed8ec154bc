// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The interface between the program and a filter's module.
///
/// A module exports one symbol of plain C data. The program compares magic, ABI text and name before it calls the
/// module for its declaration, a C++ object.
///
///     SCANMILL_FILTER() { return Declare<MyParams>("my-filter", 1)….run(…); }

#include "scanmill/filter/declare.hpp"
#include "scanmill/plugin/plugin_descriptor.hpp"

/// Use it exactly once per module; its body returns the declaration. SCANMILL_FILTER_NAME comes from
/// scanmill_add_filter().
#define SCANMILL_FILTER() SCANMILL_MODULE("scanmill-filter", SCANMILL_FILTER_NAME, scanmill::FilterDeclaration)
