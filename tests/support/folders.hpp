// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The folders of this build, found at run time from the test program's own path. No object file contains a path of the
/// machine, so a compiler cache serves every checkout.

#include <string>

namespace scanmill::test {

const std::string& build_folder();
/// The sources that the build was configured for, from the file `source-folder.txt` of the build folder.
const std::string& source_folder();
/// A workflow of the product.
std::string shipped(const std::string& name);
/// The program `scanmill`.
const std::string& program_file();
/// The filters of the product.
const std::string& plugin_folder();
/// The filters that only tests use.
const std::string& test_plugin_folder();

}  // namespace scanmill::test
