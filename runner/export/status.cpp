// SPDX-License-Identifier: GPL-3.0-or-later
#include "export/status.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <map>
#include <string>
#include <system_error>
#include <vector>

#include "commands/commands.hpp"
#include "commands/common.hpp"
#include "output/terminal.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/kinds/document.hpp"
#include "scanmill/session/chunks.hpp"

namespace scanmill::runner {

/// The command that runs these chunks of the export in `folder` again.
static std::string repeating_command(const std::filesystem::path& folder, const std::vector<std::string>& chunks) {
    std::error_code absent;
    if (const std::filesystem::path submit = folder / "submit.sh"; std::filesystem::exists(submit, absent))
        return fmt::format("{} {}", shell_word(submit), fmt::join(chunks, ","));
    // Snakemake goes by these marks; a chunk that failed at its last attempt has one, too.
    std::string marks;
    for (const std::string& chunk : chunks) marks += " " + shell_word(folder / fmt::format("done/{:0>4}", chunk));
    for (const char* rule : {"done/merge", "done/report"}) marks += " " + shell_word(folder / rule);
    return fmt::format("rm -f{}; snakemake -s {} -j 4", marks, shell_word(folder / "Snakefile"));
}

int print_status(const std::filesystem::path& folder, bool json) {
    const std::vector<ChunkStatus> states = chunk_states(folder);
    std::map<ChunkState, std::vector<std::string>> chunks;
    std::size_t cells = 0, failed = 0;
    for (const ChunkStatus& status : states) {
        chunks[status.state].push_back(std::to_string(status.chunk));
        cells += status.cells;
        failed += status.failed_cells;
    }
    if (json) {
        print_document(json_of(BatchStatusDocument{states}));
    } else {
        for (const auto& [state, numbers] : chunks)
            fmt::print("{:<8} {:>5}  {}\n", name_of(state), numbers.size(), fmt::join(numbers, ","));
        fmt::print("{} recorded in {}, of which {} failed\n", count_text(cells, "cell is", "cells are"),
                   count_text(states.size(), "chunk", "chunks"), failed);
        if (chunks.contains(ChunkState::failed))
            fmt::print(
                "a failed chunk was interrupted or killed, or its machine ran out of memory or disk; its cells "
                "that had finished are in the cache\n"
                "to run the failed chunks again: {}\n",
                repeating_command(folder, chunks[ChunkState::failed]));
    }
    return chunks.contains(ChunkState::failed) ? some_failed : done;
}

}  // namespace scanmill::runner
