// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// What a worker process does: jobs, one after the other, until nobody sends any.

namespace scanmill {

/// The descriptor on which a worker process finds its runner.
inline constexpr int worker_channel = 3;

/// Returns the process's exit code. Ends with the runner, whatever ends that.
int serve_as_worker();

}  // namespace scanmill
