// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/cache/run_values.hpp"

#include <fmt/format.h>

#include "scanmill/base/error.hpp"
#include "scanmill/workflow/sizes.hpp"

namespace scanmill {

std::filesystem::path RunValues::file_of(const ValueSlot& slot) const {
    return folder_ / fmt::format("{}.{}", slot.first, slot.second);
}

void RunValues::put(const ValueSlot& slot, const EncodedValue& value) {
    if (are_in_memory()) {
        values_.insert_or_assign(slot, value.value());
        return;
    }
    try {
        value.write(file_of(slot));
    } catch (const Error& error) {
        throw error
            .reworded(fmt::format("a value of {} cannot be passed to the next step: {}", byte_size_text(value.size()),
                                  error.sentence()))
            .hint("set TMPDIR to a folder with more free space");
    }
}

bool RunValues::contains(const ValueSlot& slot) const {
    std::error_code absent;
    return are_in_memory() ? values_.contains(slot) : std::filesystem::exists(file_of(slot), absent);
}

std::optional<Value> RunValues::find(const ValueSlot& slot) const {
    if (!contains(slot)) return std::nullopt;
    return are_in_memory() ? values_.at(slot) : read_value(file_of(slot));
}

void RunValues::remove(const ValueSlot& slot) {
    std::error_code absent;
    if (are_in_memory())
        values_.erase(slot);
    else
        std::filesystem::remove(file_of(slot), absent);
}

}  // namespace scanmill
