// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/filter/context.hpp"

#include <fmt/format.h>

namespace scanmill {

Context::Context(ContextOptions options)
    : Execution(options),
      seed_(options.seed),
      scratch_(std::move(options.scratch)),
      on_warning_(std::move(options.on_warning)) {}

void Context::warn(std::string text) {
    const std::scoped_lock lock(mutex_);
    if (warnings_.size() > most_warnings) return;
    if (warnings_.size() == most_warnings) text = fmt::format("there were more than {} warnings", most_warnings);
    if (on_warning_) on_warning_(text);
    warnings_.push_back(std::move(text));
}

void Context::doubt(std::string text, std::string port) {
    const std::scoped_lock lock(mutex_);
    if (doubts_.size() < most_warnings) doubts_.push_back({std::move(text), std::move(port)});
}

void Context::metric(std::string_view name, double value, Unit unit) {
    const std::scoped_lock lock(mutex_);
    metrics_.set(name, value, unit);
}

}  // namespace scanmill
