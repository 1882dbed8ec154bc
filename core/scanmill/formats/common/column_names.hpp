// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Names of columns in a format that allows fewer names than we do: each stays one of its own, and changes are told.

#include <set>
#include <string>
#include <string_view>

#include "scanmill/formats/common/format.hpp"

namespace scanmill {

/// The text as valid UTF-8 without control characters, which JSON and XML need: every other byte becomes '_'.
std::string valid_text(std::string_view text);

class WrittenNames {
public:
    /// `taken` are names that mean something else in the format. The options must outlive this.
    WrittenNames(std::string_view format, const WriteOptions& options, std::set<std::string> taken = {});

    /// `wanted`, or with "_2" behind it as often as it takes to be a new name. Told when that is not `expected`, the
    /// name that the format's page lets people look for.
    std::string add(std::string_view column, std::string wanted, std::string_view expected);
    std::string add(std::string_view column, std::string wanted) { return add(column, std::move(wanted), column); }

private:
    std::string format_;
    const WriteOptions* options_;
    std::set<std::string> taken_;
};

}  // namespace scanmill
