// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// A folder of one's own for temporary files.

#include <filesystem>

namespace scanmill {

/// Below the system's temporary folder, removed with everything in it. What a killed process left there is removed by
/// the next one.
class ScratchFolder {
public:
    /// Throws Error when none can be made.
    ScratchFolder();
    ~ScratchFolder();
    ScratchFolder(const ScratchFolder&) = delete;
    ScratchFolder& operator=(const ScratchFolder&) = delete;

    /// A folder in it, emptied if it is there.
    std::filesystem::path folder(const std::string& name) const;

private:
    std::filesystem::path path_;
    int lock_ = -1;  // held as long as the folder is in use
};

}  // namespace scanmill
