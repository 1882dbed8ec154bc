// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Results of steps, kept for later runs and shared by all runs on the machine.
///
/// Three kinds of files, each named by a 128-bit hash and never changed: plans/ (a step's plan key → its run key),
/// steps/ (run key → StepResult), values/ (content → value file); and files/, which remembers scans that were hashed.
/// Any number of processes may read, write, clear and
/// evict at once: files appear whole, and whoever finds one missing computes it again. What is damaged is removed,
/// told, and counts as missing. A folder that cannot be written to gives what it has.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>

#include "scanmill/cache/step_result.hpp"
#include "scanmill/cache/value_file.hpp"

namespace scanmill {

struct CacheInfo {
    std::filesystem::path folder;
    std::size_t steps = 0, values = 0;
    u64 bytes = 0;  ///< of all files
    u64 limit = 0;
};

/// $XDG_CACHE_HOME/scanmill, else ~/.cache/scanmill. Throws Error when neither variable is an absolute path.
std::filesystem::path default_cache_folder();

class Cache {
public:
    static constexpr u64 default_limit = u64(20) << 30;
    using OnWarning = std::function<void(std::string)>;

    /// Touches nothing yet. Beyond `limit` bytes, evict() removes what was used longest ago.
    explicit Cache(std::filesystem::path folder, u64 limit = default_limit, OnWarning on_warning = {});

    std::optional<std::string> run_key(std::string_view plan_key) const;
    std::optional<StepResult> step(std::string_view run_key) const;
    /// A value file of this content, and of as many bytes as it must have.
    bool has_value(std::string_view content, u64 bytes) const;
    std::optional<Value> value(std::string_view content) const;

    /// False when it could not be written; the first reason is told once.
    bool keep_run_key(std::string_view plan_key, std::string_view run_key);
    bool keep_step(std::string_view run_key, const StepResult& result);
    bool keep_value(const EncodedValue& value);

    /// The hash of a file's bytes, as content_hash(). It is remembered with the file's path, size, inode and times, so
    /// that a file which stayed as it is need not be read again; one that was written within two seconds of being
    /// hashed is, because its times may not tell a later change. Throws Error as content_hash().
    std::string file_hash(const std::filesystem::path& file);

    CacheInfo info() const;
    /// Removes what was used longest ago until the rest is within nine tenths of the limit; returns the bytes removed.
    /// Does nothing within the limit. Cost: a look at every file.
    u64 evict();
    /// Removes everything that is the cache's; returns the bytes removed.
    u64 clear();

    const std::filesystem::path& folder() const { return folder_; }

private:
    std::filesystem::path place(std::string_view kind, std::string_view name) const;
    template <class Read>
    auto read(std::string_view kind, std::string_view name, Read&& read, bool marks_use = true) const
        -> decltype(read(std::filesystem::path()));
    template <class Write>
    bool write(std::string_view kind, std::string_view name, Write&& write, bool replace = false);
    void warn(std::string text) const;

    std::filesystem::path folder_;
    u64 limit_;
    OnWarning on_warning_;
    mutable std::mutex mutex_;
    bool write_failed_ = false;
};

}  // namespace scanmill
