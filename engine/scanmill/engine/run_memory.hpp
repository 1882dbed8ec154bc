// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// What one run knows of the cache: how fast it is, and what making each node's values again would cost.

#include <map>
#include <optional>

#include "scanmill/cache/cache.hpp"
#include "scanmill/cache/keep_rule.hpp"
#include "scanmill/engine/step_runner.hpp"

namespace scanmill {

/// Without a cache it remembers nothing and keeps nothing.
class RunMemory {
public:
    RunMemory(Cache* cache, KeepRule::Policy policy) : cache_(cache), rule_(policy) {}

    std::optional<StepResult> result(const std::string& run_key) const {
        return cache_ ? cache_->step(run_key) : std::nullopt;
    }
    std::optional<Value> value(const std::string& content) const {
        return cache_ ? cache_->value(content) : std::nullopt;
    }
    void connect(const std::string& plan_key, const std::string& run_key) {
        if (cache_) cache_->keep_run_key(plan_key, run_key);
    }
    void keep_result(const std::string& plan_key, const std::string& run_key, const StepResult& result) {
        if (cache_ && cache_->keep_step(run_key, result)) connect(plan_key, run_key);
    }
    /// Keeps the values where the rule says so; `cost` is what making them took, with everything unkept upstream.
    std::vector<ResultOutput> keep_values(std::size_t node, const std::vector<StepInput>& values, double cost);
    /// Seconds to make the node's values again; 0 when they were kept or came from the cache.
    double cost_of(std::size_t node) const {
        const auto known = costs_.find(node);
        return known == costs_.end() ? 0 : known->second;
    }

private:
    Cache* cache_;
    KeepRule rule_;
    std::map<std::size_t, double> costs_;
};

}  // namespace scanmill
