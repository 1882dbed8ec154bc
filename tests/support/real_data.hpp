// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Where tests find real scans: what `make data` fetched (build/data) and, when present, a shared collection beside the
/// project. Nothing of either is in the repository, so a test is skipped where a collection is missing; a file missing
/// in a collection that is there is a failure of the test that reads it.

#include <gtest/gtest.h>

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace scanmill::test {

/// A file under build/data, "meshes/femur.off"; nothing when its collection, "meshes", was not fetched.
std::optional<std::filesystem::path> fetched_data(std::string_view name);
/// A file under ../shared/data, "1-bunny/bun_zipper.ply"; nothing when that folder is not there.
std::optional<std::filesystem::path> shared_data(std::string_view name);
/// Why a test without its file is skipped: "needs build/data (make data): meshes/femur.off". Names in ../shared/data
/// begin with a number. tools/test.sh counts the tests by what is before the colon.
std::string missing_data(std::string_view name);

}  // namespace scanmill::test

/// Declares `variable` as the path of a real scan, or ends the test as skipped.
#define SCANMILL_REAL_SCAN(variable, source, name)                               \
    const auto variable##_found = ::scanmill::test::source(name);                \
    if (!variable##_found) GTEST_SKIP() << ::scanmill::test::missing_data(name); \
    const std::filesystem::path variable = *variable##_found
