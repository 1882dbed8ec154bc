// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Names of output files: templates over {scan} (the file's stem), {folder} (the name of the
/// folder that it lies in), {variant} and {workflow}.

#include <string>

#include "scanmill/workflow/diagnostics.hpp"

namespace scanmill {

struct TemplateValues {
    std::string scan, variant, workflow, folder;
};

/// Reports unknown placeholders, unbalanced braces, absolute paths, paths that leave the output folder and paths that
/// are not in normal form (`a//b`, `a/../b`), so that equal files have equal names.
void check_template(const std::string& file, Position position, Diagnostics& diagnostics);

bool mentions(const std::string& file, const std::string& placeholder);

/// The file's name relative to the output folder, in normal form. Throws Error when a value makes it leave the folder.
std::string expand_template(const std::string& file, const TemplateValues& values);

}  // namespace scanmill
