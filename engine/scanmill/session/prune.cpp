// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/session/prune.hpp"

#include <algorithm>
#include <fstream>
#include <optional>
#include <set>

#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/compare/recorded.hpp"
#include "scanmill/plan/output_names.hpp"
#include "scanmill/session/output_lock.hpp"
#include "scanmill/worker/file_description.hpp"

namespace scanmill {

namespace {

namespace fs = std::filesystem;

/// The runs that stay: the newest `keep` of every batch, and those with a valid acceptance.
std::set<std::int64_t> runs_to_keep(const RunRecords& records, std::size_t keep) {
    std::set<std::int64_t> kept;
    std::map<std::string, std::size_t> count;  // by batch
    const std::vector<RunSummary> runs = records.runs();
    for (auto run = runs.rbegin(); run != runs.rend(); ++run)
        if (count[run->workflow]++ < keep) kept.insert(run->id);
    for (const Acceptance& acceptance : records.acceptances())
        if (!acceptance.revoked_at) kept.insert(acceptance.run);
    return kept;
}

/// The SHA-256 of the file's bytes; empty if it cannot be read.
std::string sha256_of(const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    Sha256 hash;
    std::vector<char> buffer(1 << 20);
    while (stream.read(buffer.data(), static_cast<std::streamsize>(buffer.size())), stream.gcount() > 0)
        hash.add({buffer.data(), static_cast<std::size_t>(stream.gcount())});
    return stream.eof() ? hash.text() : "";
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

/// Removes the file and its description, and the folders that are empty then.
void remove_file(const fs::path& file, const fs::path& folder) {
    for (const fs::path& each : {file, description_of(file)}) {
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
    for (const RecordedFile& file : records.files()) last[file.path] = std::max(last[file.path], file.run);
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
    if (!dry_run) lock.emplace(folder, command_line, warn);
    const std::set<std::int64_t> kept = runs_to_keep(records, keep);
    Pruned pruned;
    for (const RunSummary& run : records.runs())
        if (!kept.contains(run.id)) pruned.runs.push_back(run.id);

    const std::vector<RecordedFile> files = records.files();
    std::set<std::string> named;  // by a run that stays
    std::map<std::string, std::vector<const RecordedFile*>> unnamed;
    for (const RecordedFile& file : files)
        if (kept.contains(file.run)) named.insert(file.path);
    for (const RecordedFile& file : files)
        if (!named.contains(file.path)) unnamed[file.path].push_back(&file);
    std::error_code ignored;
    const fs::path whole = fs::weakly_canonical(folder, ignored);
    for (const auto& [path, recorded] : unnamed) {
        const fs::path file = fs::weakly_canonical(path, ignored);
        if (!fs::is_regular_file(file, ignored)) continue;
        if (!is_below(file, whole))
            ++pruned.outside;
        else if (!has_recorded_bytes(file, recorded))
            ++pruned.changed;
        else {
            pruned.bytes += fs::file_size(file, ignored);
            pruned.files.push_back(file);
        }
    }
    warn_of_gone_files(records, kept, warn);
    pruned.records_before = pruned.records_after = fs::file_size(folder / records_file, ignored);
    if (dry_run || pruned.runs.empty()) return pruned;
    for (const fs::path& file : pruned.files) remove_file(file, whole);
    records.remove(pruned.runs, warn);
    pruned.records_after = fs::file_size(folder / records_file, ignored);
    return pruned;
}

}  // namespace scanmill
