// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/cache/cache.hpp"

#include <fcntl.h>
#include <linux/magic.h>
#include <sys/stat.h>
#include <sys/vfs.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <limits>
#include <map>
#include <vector>

#include "scanmill/base/error.hpp"
#include "scanmill/base/hash.hpp"
#include "scanmill/io/atomic_file.hpp"

namespace scanmill {

namespace {

namespace fs = std::filesystem;

constexpr std::string_view layout = "v1";
constexpr std::array<std::string_view, 4> kinds{"plans", "steps", "values", "files"};

struct CachedFile {
    fs::path path;
    std::string_view kind;
    u64 bytes;
    std::int64_t used;  ///< time of the last use, in nanoseconds since 1970
};

std::int64_t nanoseconds(const timespec& time) { return std::int64_t(time.tv_sec) * 1'000'000'000 + time.tv_nsec; }

/// Temporary files, and those that network file systems keep for processes that have them open.
bool is_hidden(const fs::path& file) { return file.filename().string().starts_with('.'); }

std::vector<CachedFile> all_files(const fs::path& folder) {
    std::vector<CachedFile> files;
    for (const std::string_view kind : kinds) {
        std::error_code gone;  // other processes may remove files meanwhile
        for (fs::recursive_directory_iterator entry(folder / layout / kind, gone), end; !gone && entry != end;
             entry.increment(gone)) {
            struct stat properties;
            if (::stat(entry->path().c_str(), &properties) != 0 || !S_ISREG(properties.st_mode)) continue;
            if (is_hidden(entry->path()) && !is_abandoned_part(entry->path())) continue;
            files.push_back(
                {entry->path(), kind, static_cast<u64>(properties.st_size), nanoseconds(properties.st_mtim)});
        }
    }
    return files;
}

u64 remove(const CachedFile& file) {
    std::error_code gone;
    return fs::remove(file.path, gone) ? file.bytes : 0;
}

/// Adds up the sizes of files by the names that step results contain.
class UseByName {
public:
    /// `rest` is the name for files without a name.
    explicit UseByName(std::string rest) : rest_(std::move(rest)) {}

    /// Adds the file of a step, and gives the name to the step's values.
    void add_step(const CachedFile& file, const std::string& name, const StepResult& result) {
        bytes_[name] += file.bytes;
        for (const ResultOutput& output : result.outputs) {
            std::string& value = name_of_value_.emplace(output.content, name).first->second;
            if (value == rest_ || (name != rest_ && name < value)) value = name;
        }
    }
    /// Adds any other file. Pre: all steps were added.
    void add(const CachedFile& file) {
        const auto found =
            file.kind == "values" ? name_of_value_.find(file.path.filename().string()) : name_of_value_.end();
        bytes_[found == name_of_value_.end() ? rest_ : found->second] += file.bytes;
    }
    /// The largest first, then by name.
    std::vector<CacheUse> uses() const {
        std::vector<CacheUse> all;
        for (const auto& [name, bytes] : bytes_) all.push_back({name, bytes});
        std::ranges::stable_sort(all, std::ranges::greater(), &CacheUse::bytes);
        return all;
    }

private:
    std::string rest_;
    std::map<std::string, u64> bytes_;
    std::map<std::string, std::string> name_of_value_;  // by content
};

/// The result of the step in the file; empty for a damaged file, which is reported when it is used.
std::optional<StepResult> step_in(const CachedFile& file) {
    try {
        if (const std::optional<std::string> bytes = read_checked(file.path, "step")) return step_result_from(*bytes);
    } catch (const Error&) {
    }
    return std::nullopt;
}

void add_uses_by_name(const std::vector<CachedFile>& files, CacheInfo& info) {
    const std::string unknown = "unknown";
    UseByName filters("(other)"), workflows(unknown);
    std::vector<const CachedFile*> others;
    for (const CachedFile& file : files) {
        const std::optional<StepResult> step = file.kind == "steps" ? step_in(file) : std::nullopt;
        if (step) {
            filters.add_step(file, step->filter.empty() ? "(scans)" : step->filter, *step);
            workflows.add_step(file, step->workflow.empty() ? unknown : step->workflow, *step);
        } else {
            others.push_back(&file);
        }
    }
    for (const CachedFile* file : others) {
        filters.add(*file);
        workflows.add(*file);
    }
    info.by_filter = filters.uses();
    info.by_workflow = workflows.uses();
}

std::vector<CacheUse> use_by_age(const std::vector<CachedFile>& files) {
    constexpr std::int64_t day = 24 * 3600 * std::int64_t(1'000'000'000);
    constexpr std::array<std::int64_t, 3> most_days{1, 7, 30};
    std::vector<CacheUse> uses{{"last day", 0}, {"last 7 days", 0}, {"last 30 days", 0}, {"older", 0}};
    timespec now;
    ::clock_gettime(CLOCK_REALTIME, &now);
    for (const CachedFile& file : files) {
        const std::int64_t age = nanoseconds(now) - file.used;
        const auto bucket = std::ranges::find_if(most_days, [&](std::int64_t days) { return age < days * day; });
        uses[static_cast<std::size_t>(bucket - most_days.begin())].bytes += file.bytes;
    }
    return uses;
}

bool is_on_network(const fs::path& folder) {
    constexpr std::array<unsigned, 8> network{NFS_SUPER_MAGIC, SMB_SUPER_MAGIC,  SMB2_SUPER_MAGIC, CIFS_SUPER_MAGIC,
                                              AFS_SUPER_MAGIC, CODA_SUPER_MAGIC, V9FS_MAGIC,       FUSE_SUPER_MAGIC};
    struct statfs system;
    return ::statfs(folder.c_str(), &system) == 0 &&
           std::ranges::find(network, static_cast<unsigned>(system.f_type)) != network.end();
}

fs::path tag_of(const fs::path& folder) { return folder / "CACHEDIR.TAG"; }

/// The time of the clock that sets the times of files in the folder, in nanoseconds since 1970. The clock of a file
/// server may differ from that of this machine.
std::int64_t now_in(const fs::path& folder) {
    const fs::path tag = tag_of(folder);
    timespec now;
    ::clock_gettime(CLOCK_REALTIME, &now);
    struct stat properties;
    if (::utimensat(AT_FDCWD, tag.c_str(), nullptr, 0) == 0 && ::stat(tag.c_str(), &properties) == 0)
        now = properties.st_mtim;
    return nanoseconds(now);
}

/// Makes backup programs skip the folder: https://bford.info/cachedir/
void mark_as_cache(const fs::path& folder) {
    const fs::path tag = tag_of(folder);
    std::error_code ignored;
    if (fs::exists(tag, ignored)) return;
    std::ofstream(tag) << "Signature: 8a477f597d28d172789f06886806bc55\n# Results that scanmill can compute again.\n";
}

}  // namespace

fs::path default_cache_folder() {
    const char* cache_home = std::getenv("XDG_CACHE_HOME");
    if (cache_home && fs::path(cache_home).is_absolute()) return fs::path(cache_home) / "scanmill";
    const char* home = std::getenv("HOME");
    if (home && fs::path(home).is_absolute()) return fs::path(home) / ".cache" / "scanmill";
    throw Error("there is no folder for the cache: neither XDG_CACHE_HOME nor HOME is an absolute path")
        .hint("set one of them")
        .remedy(Remedy::choose_cache_folder);
}

u64 default_cache_limit_of(u64 capacity) { return std::min(Cache::largest_default_limit, capacity / 10); }

u64 default_cache_limit(const fs::path& folder) {
    std::error_code trouble;
    fs::path existing = fs::absolute(folder, trouble);
    while (!fs::exists(existing, trouble) && existing.has_relative_path()) existing = existing.parent_path();
    const fs::space_info space = fs::space(existing, trouble);
    return trouble || space.capacity == 0 ? Cache::largest_default_limit : default_cache_limit_of(space.capacity);
}

Cache::Cache(fs::path folder, u64 limit, OnWarning on_warning)
    : folder_(std::move(folder)),
      limit_(limit),
      on_warning_(std::move(on_warning)) {}

fs::path Cache::path_of(std::string_view kind, std::string_view name) const {
    return folder_ / layout / kind / name.substr(0, 2) / name;
}

void Cache::warn(std::string text) const {
    const std::scoped_lock one_at_a_time(mutex_);
    if (on_warning_) on_warning_(std::move(text));
}

template <class Read>
auto Cache::read(std::string_view kind, std::string_view name, Read&& read, bool marks_use) const
    -> decltype(read(fs::path())) {
    const fs::path file = path_of(kind, name);
    for (int attempt = 1;; ++attempt) {
        std::error_code trouble;
        try {
            auto found = read(file);
            if (found && marks_use)
                ::utimensat(AT_FDCWD, file.c_str(), nullptr, 0);  // sets the time to now; fails on a read-only folder
            return found;
        } catch (const DamagedFile& error) {
            if (!fs::exists(file, trouble)) return std::nullopt;  // another process removed it
            const bool removed = fs::remove(file, trouble);
            warn(fmt::format("an entry of the cache {} and counts as missing: {}",
                             removed ? "was removed" : "cannot be removed", error.sentence()));
            return std::nullopt;
        } catch (const Error& error) {
            if (!fs::exists(file, trouble)) return std::nullopt;
            // On a network file system, a file that was replaced on another machine can be read at the next attempt.
            constexpr int most_attempts = 3;
            if (attempt < most_attempts) continue;
            warn(fmt::format("an entry of the cache counts as missing: {}", error.sentence()));
            return std::nullopt;
        }
    }
}

std::optional<std::string> Cache::run_key(std::string_view plan_key) const {
    return read("plans", plan_key, [](const fs::path& file) { return read_checked(file, "plan"); });
}

std::optional<StepResult> Cache::step(std::string_view run_key) const {
    return read("steps", run_key, [](const fs::path& file) -> std::optional<StepResult> {
        const std::optional<std::string> bytes = read_checked(file, "step");
        if (!bytes) return std::nullopt;
        try {
            return step_result_from(*bytes);
        } catch (const Error& error) {
            throw DamagedFile(error);
        }
    });
}

bool Cache::has_value(std::string_view content, u64 bytes) const {
    std::error_code absent;
    const auto found = fs::file_size(path_of("values", content), absent);
    return !absent && (found == bytes || value(content));  // value() removes a damaged file
}

std::optional<Value> Cache::value(std::string_view content) const {
    return read("values", content, [&](const fs::path& file) -> std::optional<Value> {
        std::error_code absent;
        if (!fs::exists(file, absent)) return std::nullopt;
        return read_value(file, content);
    });
}

template <class Write>
bool Cache::write(std::string_view kind, std::string_view name, Write&& write, bool replace) {
    const fs::path file = path_of(kind, name);
    try {
        std::error_code trouble;
        if (!replace && fs::exists(file, trouble)) return true;  // equal names mean equal bytes
        fs::create_directories(file.parent_path(), trouble);
        if (trouble) throw Error("a folder in it cannot be made: {}", trouble.message());
        mark_as_cache(folder_ / layout);
        write(file);
        return true;
    } catch (const Error& error) {
        // The sentence does not name the file, so that all worker processes give the same warning.
        if (!write_failed_.exchange(true))
            warn(fmt::format(
                "the cache '{}' does not store new results: {}; choose another folder if they should be kept",
                folder_.string(), error.sentence()));
        return false;
    }
}

bool Cache::keep_run_key(std::string_view plan_key, std::string_view run_key) {
    return write("plans", plan_key, [&](const fs::path& file) { write_checked(file, "plan", run_key); });
}

bool Cache::keep_step(std::string_view run_key, const StepResult& result) {
    return write("steps", run_key, [&](const fs::path& file) { write_checked(file, "step", to_bytes(result)); });
}

bool Cache::keep_value(const EncodedValue& value) {
    return write("values", value.content(), [&](const fs::path& file) { value.write(file); });
}

std::string Cache::file_hash(const fs::path& file) {
    struct stat properties;
    std::error_code unknown;
    const fs::path whole = fs::absolute(file, unknown);
    if (unknown || ::stat(whole.c_str(), &properties) != 0) return content_hash(file);  // throws
    const std::string description =
        fmt::format("{} {} {}.{:09} {}.{:09}", properties.st_ino, properties.st_size, properties.st_mtim.tv_sec,
                    properties.st_mtim.tv_nsec, properties.st_ctim.tv_sec, properties.st_ctim.tv_nsec);
    // A device has another number on every machine. Machines must not overwrite each other's entries.
    const std::string name =
        KeyBuilder().field("file", whole.string()).field("device", std::to_string(properties.st_dev)).key();
    constexpr time_t settled = 2;
    const time_t changed = std::max(properties.st_mtim.tv_sec, properties.st_ctim.tv_sec);
    const auto memo = read(
        "files", name, [](const fs::path& of) { return read_checked(of, "file"); }, false);
    if (memo && memo->starts_with(description + " ")) {
        // File systems set both times: when the hash was stored, and when the file last changed.
        struct stat written;
        if (::stat(path_of("files", name).c_str(), &written) == 0 && written.st_mtim.tv_sec - changed > settled)
            return memo->substr(description.size() + 1);
    }
    timespec now;
    ::clock_gettime(CLOCK_REALTIME, &now);
    std::string hash = content_hash(file);
    if (now.tv_sec - changed <= settled) return hash;
    write(
        "files", name, [&](const fs::path& to) { write_checked(to, "file", description + " " + hash); }, true);
    return hash;
}

CacheInfo Cache::info() const {
    CacheInfo info;
    info.folder = folder_;
    info.limit = limit_;
    const std::vector<CachedFile> files = all_files(folder_);
    for (const CachedFile& file : files) {
        info.steps += file.kind == "steps";
        info.values += file.kind == "values";
        info.bytes += file.bytes;
    }
    add_uses_by_name(files, info);
    info.by_age = use_by_age(files);
    return info;
}

u64 Cache::evict() {
    std::vector<CachedFile> files = all_files(folder_);
    u64 total = 0, removed = 0;
    std::erase_if(files, [&](const CachedFile& file) {
        if (!is_hidden(file.path)) return false;
        removed += remove(file);
        return true;
    });
    for (const CachedFile& file : files) total += file.bytes;
    if (total <= limit_) return removed;
    std::ranges::sort(files, {}, &CachedFile::used);
    constexpr std::int64_t hour = 3600 * std::int64_t(1'000'000'000);
    const std::int64_t newest =
        is_on_network(folder_) ? now_in(folder_ / layout) - hour : std::numeric_limits<std::int64_t>::max();
    const u64 wanted = limit_ / 10 * 9;
    for (const CachedFile& file : files) {
        if (total <= wanted || file.used > newest) break;
        removed += remove(file);
        total -= file.bytes;  // also if another process has just removed it
    }
    return removed;
}

u64 Cache::clear() {
    u64 removed = 0;
    for (const CachedFile& file : all_files(folder_)) removed += remove(file);
    return removed;
}

}  // namespace scanmill
