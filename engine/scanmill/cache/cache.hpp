// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Stores results of steps for later runs. All runs on the machine share them.
///
/// Three folders hold files that are named by a 128-bit hash and never change: plans/ (plan key → run key of a step),
/// steps/ (run key → StepResult) and values/ (content → value file). The folder files/ stores the hashes of scans.
///
/// Any number of processes may read, write, clear and evict at once, on any machines that share the folder: there are
/// no locks, and a file appears whole or not at all (AtomicFile). Runs compute missing results again. A damaged file is
/// removed with a warning and counts as missing. A read-only cache can be read.
///
/// On a network file system, a file that one machine removes can no longer be read by others that have mapped it.
/// evict() therefore keeps files that were used within the last hour, and clear() must not be called during runs.

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "scanmill/cache/step_result.hpp"
#include "scanmill/cache/value_file.hpp"

namespace scanmill {

/// The total size of some of the cache's files.
struct CacheUse {
    std::string name;
    u64 bytes = 0;

    bool operator==(const CacheUse&) const = default;
};

struct CacheInfo {
    std::filesystem::path folder;
    std::size_t steps = 0, values = 0;
    u64 bytes = 0;  ///< total size of all files
    u64 limit = 0;  ///< in bytes
    /// By the filter whose results the files hold, the largest first, then by name. A value of several filters counts
    /// for the first name. "(scans)": scans that were read; "(other)": keys, and what no readable step refers to.
    std::vector<CacheUse> by_filter;
    /// By the workflow that stored the results, in the same way. "unknown": keys, results of older versions, and what
    /// no readable step refers to. A value with a known and an unknown workflow counts for the known one.
    std::vector<CacheUse> by_workflow;
    /// By the time since the last use: less than a day, 7 days, 30 days, and more. Each file counts once.
    std::vector<CacheUse> by_age;
};

/// Decides which values are stored.
///
/// A value is stored if computing it again takes more than twice as long as writing it. The time to compute includes
/// inputs that are not stored. The writing speed is 500 MB per second until wrote() has measured it.
class KeepRule {
public:
    enum class Policy { never, worth, always };

    explicit KeepRule(Policy policy = Policy::worth) : policy_(policy) {}

    bool is_worth(double seconds_to_make, u64 bytes) const {
        if (policy_ != Policy::worth) return policy_ == Policy::always;
        constexpr double margin = 2;
        return seconds_to_make > margin * static_cast<double>(bytes) / bytes_per_second_;
    }
    /// Updates the writing speed. Small files are ignored, because creating a file takes most of their time.
    void wrote(u64 bytes, double seconds) {
        constexpr u64 least = 1 << 20;
        if (bytes < least || !(seconds > 0)) return;
        written_ += static_cast<double>(bytes);
        seconds_ += seconds;
        bytes_per_second_ = written_ / seconds_;
    }
    double bytes_per_second() const { return bytes_per_second_; }

private:
    Policy policy_;
    double written_ = 0, seconds_ = 0;
    double bytes_per_second_ = 5e8;
};

/// $XDG_CACHE_HOME/scanmill, or else $HOME/.cache/scanmill. Throws Error if neither variable is an absolute path.
std::filesystem::path default_cache_folder();

/// The size limit of a cache in `folder` for which none is given: a tenth of the capacity of the file system that holds
/// the folder, or will hold it, but at most Cache::largest_default_limit, also if the capacity is unknown.
u64 default_cache_limit(const std::filesystem::path& folder);

/// default_cache_limit() for a file system of `capacity` bytes.
u64 default_cache_limit_of(u64 capacity);

class Cache {
public:
    static constexpr u64 largest_default_limit = u64(20) << 30;
    using OnWarning = std::function<void(std::string)>;

    /// Accesses no file. `limit` is the size in bytes above which evict() removes files.
    explicit Cache(std::filesystem::path folder, u64 limit = largest_default_limit, OnWarning on_warning = {});

    std::optional<std::string> run_key(std::string_view plan_key) const;
    std::optional<StepResult> step(std::string_view run_key) const;
    /// Whether the cache has a value file of this content and size.
    bool has_value(std::string_view content, u64 bytes) const;
    std::optional<Value> value(std::string_view content) const;

    // The keep functions return false if the file cannot be written. Only the first failure gives a warning.
    bool keep_run_key(std::string_view plan_key, std::string_view run_key);
    bool keep_step(std::string_view run_key, const StepResult& result);
    bool keep_value(const EncodedValue& value);

    /// The hash of a file's bytes, as content_hash() returns it. The cache stores it with the file's path, device,
    /// size, inode and times. An unchanged file is not read again, unless it was hashed within two seconds after it was
    /// written, by the clock of this machine or by that of the cache's: a later change might not show in its times.
    /// Throws Error as content_hash() does.
    std::string file_hash(const std::filesystem::path& file);

    /// Cost: one stat() per file, and reading the results of all steps, without their values.
    CacheInfo info() const;
    /// If the limit is exceeded, removes the least recently used files until the rest takes nine tenths of the limit.
    /// Also removes temporary files of writers that were killed. Returns the number of bytes removed. Cost: one stat()
    /// per file.
    u64 evict();
    /// Removes all files of the cache. Returns the number of bytes removed.
    u64 clear();

    const std::filesystem::path& folder() const { return folder_; }

private:
    std::filesystem::path path_of(std::string_view kind, std::string_view name) const;
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
    std::atomic<bool> write_failed_ = false;
};

}  // namespace scanmill
