// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The link between long-running code and its caller: progress, cancellation, threads.

#include <algorithm>
#include <functional>
#include <mutex>

namespace scanmill {

/// Thrown by check_cancelled(); passes through algorithms untouched.
struct __attribute__((visibility("default"))) Cancelled {};

struct ExecutionOptions {
    /// Number of threads, at least 1. Results do not depend on it.
    unsigned threads = 1;
    /// Called from any thread, one call at a time.
    std::function<void(double fraction)> on_progress;
    std::function<bool()> is_cancelled;
};

class Execution {
public:
    explicit Execution(ExecutionOptions options = {}) : options_(std::move(options)) {
        options_.threads = std::max(1u, options_.threads);
    }
    Execution(const Execution&) = delete;
    Execution& operator=(const Execution&) = delete;

    unsigned threads() const { return options_.threads; }
    /// Reports the fraction of the work that is done, from 0 to 1; NaN (0 of 0 items) counts as 0. Callable from any
    /// thread.
    void progress(double fraction) {
        if (!options_.on_progress) return;
        const std::scoped_lock lock(mutex_);
        options_.on_progress(fraction > 0 ? std::min(fraction, 1.0) : 0.0);
    }
    bool cancelled() const { return options_.is_cancelled && options_.is_cancelled(); }
    /// Throws Cancelled if the caller cancelled. Cheap enough for every chunk of work.
    void check_cancelled() const {
        if (cancelled()) throw Cancelled{};
    }

protected:
    std::mutex mutex_;  ///< locked during every call of a callback

private:
    ExecutionOptions options_;
};

}  // namespace scanmill
