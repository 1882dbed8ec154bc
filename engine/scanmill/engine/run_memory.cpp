// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/engine/run_memory.hpp"

#include <chrono>

namespace scanmill {

std::vector<ResultOutput> RunMemory::keep_values(std::size_t node, const std::vector<StepInput>& values, double cost) {
    std::vector<ResultOutput> outputs;
    bool all_kept = true;
    for (const auto& [port, value] : values) {
        const EncodedValue encoded(value);
        bool kept = cache_->has_value(encoded.content());
        if (!kept && rule_.is_worth(cost, encoded.size())) {
            const auto start = std::chrono::steady_clock::now();
            kept = cache_->keep_value(encoded);
            if (kept)
                rule_.wrote(encoded.size(),
                            std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
        }
        all_kept = all_kept && kept;
        outputs.push_back({port, kind_of(value), encoded.content(), encoded.size()});
    }
    costs_[node] = all_kept ? 0 : cost;
    return outputs;
}

}  // namespace scanmill
