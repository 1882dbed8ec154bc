// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// A Context for an algorithm that is one step of another one.

#include "scanmill/filter/context.hpp"

namespace scanmill::updating {

/// Has the threads and the cancellation of the outer Context. Progress goes to the outer one, as its fraction from
/// `begin` to `end`; if both are equal, nothing is reported. Metrics, warnings and doubts stay here.
class NestedContext : public Context {
public:
    explicit NestedContext(Context& outer, double begin = 0, double end = 0) : Context(options(outer, begin, end)) {}

private:
    static ContextOptions options(Context& outer, double begin, double end) {
        ContextOptions options;
        options.threads = outer.threads();
        options.is_cancelled = [&outer] { return outer.cancelled(); };
        if (begin < end)
            options.on_progress = [&outer, begin, end](double done) { outer.progress(begin + (end - begin) * done); };
        return options;
    }
};

}  // namespace scanmill::updating
