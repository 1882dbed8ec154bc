// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/filter/context.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace scanmill {

Context::Context(ContextOptions options) : options_(std::move(options)) {
    options_.threads = std::max(1u, options_.threads);
}

void Context::progress(double fraction) {
    if (!options_.on_progress) return;
    const std::scoped_lock lock(mutex_);
    options_.on_progress(fraction > 0 ? std::min(fraction, 1.0) : 0.0);  // NaN, nothing of nothing done, is 0
}

bool Context::cancelled() const { return options_.is_cancelled && options_.is_cancelled(); }

void Context::check_cancelled() const {
    if (cancelled()) throw Cancelled{};
}

void Context::warn(std::string text) {
    const std::scoped_lock lock(mutex_);
    if (warnings_.size() > most_warnings) return;
    if (warnings_.size() == most_warnings) text = fmt::format("there were more than {} warnings", most_warnings);
    if (options_.on_warning) options_.on_warning(text);
    warnings_.push_back(std::move(text));
}

void Context::metric(std::string_view name, double value, Unit unit) {
    const std::scoped_lock lock(mutex_);
    metrics_.set(name, value, unit);
}

}  // namespace scanmill
