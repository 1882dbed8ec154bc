// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/session/prune.hpp"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <optional>
#include <set>

#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/compare/recorded.hpp"
#include "scanmill/plan/output_names.hpp"
#include "scanmill/session/output_lock.hpp"
#include "scanmill/session/previews.hpp"
#include "scanmill/worker/file_description.hpp"

namespace scanmill {

namespace {

namespace fs = std::filesystem;

/// The path without links, so that two names of a file are one, also if the folder was moved behind a link.
std::string one_name(const std::string& path) {
    std::error_code ignored;
    const fs::path canonical = fs::weakly_canonical(path, ignored);
    return canonical.empty() ? path : canonical.string();
}

std::vector<RecordedFile> files_of(const RunRecords& records) {
    std::vector<RecordedFile> files = records.files();
    for (RecordedFile& file : files) file.path = one_name(file.path);
    return files;
}

/// The runs that stay: the newest `keep` of every batch that ended, newer ones that did not, and those with a valid
/// acceptance.
std::set<std::int64_t> runs_to_keep(const RunRecords& records, std::size_t keep) {
    std::set<std::int64_t> kept;
    std::map<std::string, std::size_t> count;  // by batch
    const std::vector<RunSummary> runs = records.runs();
    for (auto run = runs.rbegin(); run != runs.rend(); ++run)
        if (std::size_t& ended = count[run->workflow]; ended < keep) {
            kept.insert(run->id);
            ended += run->outcome && *run->outcome != "interrupted";
        }
    for (const Acceptance& acceptance : records.acceptances())
        if (!acceptance.revoked_at) kept.insert(acceptance.run);
    return kept;
}

/// Whether one of the runs recorded these bytes, or bytes without a hash, for the file.
bool has_recorded_bytes(const fs::path& file, const std::vector<const RecordedFile*>& recorded) {
    std::error_code ignored;
    const std::uintmax_t bytes = fs::file_size(file, ignored);
    std::string sha256;
    return std::ranges::any_of(recorded, [&](const RecordedFile* each) {
        if (each->sha256.empty()) return true;
        if (each->bytes != bytes) return false;
        if (sha256.empty()) sha256 = sha256_of(file);
        return each->sha256 == sha256;
    });
}

bool is_below(const fs::path& file, const fs::path& folder) {
    const fs::path inside = file.lexically_relative(folder);
    return !inside.empty() && *inside.begin() != "..";
}

/// Whether the file beside an output describes it, and is not an output of its own.
bool is_description(const fs::path& description, const std::vector<const RecordedFile*>& recorded) {
    std::ifstream stream(description, std::ios::binary);
    const std::string text(std::istreambuf_iterator<char>(stream), {});
    return std::ranges::any_of(recorded, [&](const RecordedFile* each) {
        return !each->sha256.empty() && text.find(each->sha256) != std::string::npos;
    });
}

/// Removes the files, and the folders that are empty then.
void remove_files(const std::vector<fs::path>& files, const fs::path& file, const fs::path& folder) {
    for (const fs::path& each : files) {
        std::error_code trouble;
        fs::remove(each, trouble);
        if (trouble)
            throw Error("'{}' cannot be removed: {}", each.string(), trouble.message())
                .hint("nothing is lost: repeat the command when the file can be removed");
    }
    std::error_code ignored;
    for (fs::path parent = file.parent_path(); is_below(parent, folder) && parent != folder;
         parent = parent.parent_path())
        if (!fs::is_empty(parent, ignored) || !fs::remove(parent, ignored)) break;
}

/// The names of the files that runs that stay read: an output of one workflow may be the scan of another.
std::set<std::string> names_of_read_files(const RunRecords& records, const std::set<std::int64_t>& kept) {
    std::set<std::string> names;
    for (const std::int64_t run : kept)
        for (const std::string& file : records.read_files(run)) names.insert(fs::path(file).filename().string());
    return names;
}

void warn_of_gone_files(const RunRecords& records, const std::set<std::int64_t>& kept,
                        const std::function<void(std::string)>& warn) {
    for (const auto& [run, size] : bytes_by_run(records))
        if (size.gone > 0 && kept.contains(run))
            warn(fmt::format("run {} stays, but {} gone", run,
                             count_text(size.gone, "file that it wrote is", "files that it wrote are")));
}

}  // namespace

std::map<std::int64_t, RunBytes> bytes_by_run(const RunRecords& records) {
    std::map<std::string, std::int64_t> last;  // run that named the file last
    for (const RecordedFile& file : files_of(records)) last[file.path] = std::max(last[file.path], file.run);
    std::map<std::int64_t, RunBytes> all;
    for (const auto& [path, run] : last) {
        RunBytes& size = all[run];
        std::error_code gone;
        const std::uintmax_t bytes = fs::file_size(path, gone);
        gone ? ++size.gone : size.bytes += bytes;
    }
    return all;
}

Pruned prune(const fs::path& folder, std::size_t keep, bool dry_run, const std::vector<std::string>& command_line,
             const std::function<void(std::string)>& warn) {
    RunRecords records = records_to_change(folder);
    std::optional<OutputLock> lock;
    if (!dry_run) {
        lock.emplace(folder, command_line, warn);
        if (!OutputLock::is_held(folder))
            throw Error("'{}' cannot be locked, so a run may be writing into it; nothing was removed", folder.string())
                .hint("prune on a file system with locks");
    }
    const std::set<std::int64_t> kept = runs_to_keep(records, keep);
    Pruned pruned;
    for (const RunSummary& run : records.runs())
        if (!kept.contains(run.id)) pruned.runs.push_back(run.id);

    const std::vector<RecordedFile> files = files_of(records);
    std::set<std::string> named;  // by a run that stays
    std::map<std::string, std::vector<const RecordedFile*>> unnamed;
    for (const RecordedFile& file : files)
        if (kept.contains(file.run)) named.insert(file.path);
    for (const RecordedFile& file : files)
        if (!named.contains(file.path)) unnamed[file.path].push_back(&file);
    std::error_code ignored;
    const fs::path whole = fs::weakly_canonical(folder, ignored);
    const std::set<std::string> read = names_of_read_files(records, kept);
    std::vector<std::pair<fs::path, std::vector<fs::path>>> to_remove;
    for (const auto& [path, recorded] : unnamed) {
        const fs::path file = path;
        if (!fs::is_regular_file(file, ignored)) continue;
        if (!is_below(file, whole))
            ++pruned.outside;
        else if (read.contains(file.filename().string()))
            ++pruned.read;
        else if (!has_recorded_bytes(file, recorded))
            ++pruned.changed;
        else {
            pruned.bytes += fs::file_size(file, ignored);
            pruned.files.push_back(file);
            std::vector<fs::path> all{file};
            if (const fs::path description = description_of(file);
                !named.contains(description.string()) && is_description(description, recorded))
                all.push_back(description);
            to_remove.emplace_back(file, std::move(all));
        }
    }
    std::set<std::string> hashes;  // what runs that stay wrote
    for (const RecordedFile& file : files)
        if (kept.contains(file.run)) hashes.insert(file.sha256);
    const std::vector<fs::path> previews = unused_previews(folder, hashes, read);
    for (const fs::path& preview : previews) pruned.preview_bytes += fs::file_size(preview, ignored);
    warn_of_gone_files(records, kept, warn);
    pruned.records_before = pruned.records_after = fs::file_size(folder / records_file, ignored);
    if (dry_run) return pruned;
    for (const fs::path& preview : previews) fs::remove(preview, ignored);
    if (pruned.runs.empty()) return pruned;
    for (const auto& [file, all] : to_remove) remove_files(all, file, whole);
    records.remove(pruned.runs, warn);
    pruned.records_after = fs::file_size(folder / records_file, ignored);
    return pruned;
}

}  // namespace scanmill
