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

/// The origin of a value: a node, and its output port. The port is empty for a file that is read.
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
    /// The value of the slot; empty if it is not stored. Throws Error for a damaged file.
    std::optional<Value> find(const ValueSlot& slot) const;
    /// Removes the value of the slot. A value in use stays valid.
    void remove(const ValueSlot& slot);

private:
    std::filesystem::path file_of(const ValueSlot& slot) const;

    std::filesystem::path folder_;
    std::map<ValueSlot, Value> values_;
};

}  // namespace scanmill
