// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The values that pass between the tasks of one run, each under its node and output port.

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "scanmill/cache/value_file.hpp"
#include "scanmill/kinds/value.hpp"

namespace scanmill {

/// Where a value comes from: a node, and its output port; empty for a file that is read.
using ValueSlot = std::pair<std::size_t, std::string>;

class RunValues {
public:
    /// Keeps values in the memory of this process.
    RunValues() = default;
    /// Keeps values as files in the folder, which processes may share. Readers map them.
    explicit RunValues(std::filesystem::path folder) : folder_(std::move(folder)) {}

    bool are_in_memory() const { return folder_.empty(); }
    /// Throws Error if the file cannot be written.
    void put(const ValueSlot& slot, const EncodedValue& value);
    bool contains(const ValueSlot& slot) const;
    /// Empty if it is not stored. Throws Error for a damaged file.
    std::optional<Value> find(const ValueSlot& slot) const;
    /// Values that are in use stay mapped.
    void remove(const ValueSlot& slot);

private:
    std::filesystem::path file_of(const ValueSlot& slot) const;

    std::filesystem::path folder_;
    std::map<ValueSlot, Value> values_;
};

}  // namespace scanmill
