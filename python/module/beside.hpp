// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Runs long work beside Python: on a thread of its own, while the calling thread handles Python's signals and calls
/// Python's callbacks. The work must not touch Python objects.

#include <nanobind/nanobind.h>

#include <atomic>
#include <functional>

namespace scanmill::python {

/// The link between the work and the thread that waits for it.
struct Beside {
    std::atomic<bool> is_cancelled = false;
    std::atomic<double> progress = -1;  ///< the fraction that is done; negative: not known
};

/// Runs `work` and waits for its end. `on_progress` is a callable of one number, or None. If a signal handler or the
/// callback throws, cancels the work, waits until it has ended, and throws that exception. Otherwise throws what the
/// work threw.
void run_beside(const std::function<void(Beside&)>& work, nanobind::handle on_progress);

/// Throws Error in a process that was forked after its parent had used threads: those threads are missing here, so work
/// would wait for them for ever. To be called before any work that may use threads.
void require_own_threads();

}  // namespace scanmill::python
