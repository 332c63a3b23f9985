// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <string>

#include "agent/bridge/effects.hpp"
#include "asip/expected.hpp"
#include "asip/model/labels.hpp"

namespace asip::agent {

/// Where an agent keeps what it must remember where nothing else is given: $STATE_DIRECTORY (of a service of
/// systemd), $XDG_STATE_HOME/asip, or ~/.local/state/asip; empty: there is no such place.
std::filesystem::path default_state_folder();

/// Labels of boards on the disk: FOLDER/labels/BOARD.json. A file is whole or as it was before, whenever the
/// program or the machine dies.
class LabelFiles {
  public:
    /// `folder` is made with the first file. Empty: nothing can be kept.
    explicit LabelFiles(std::filesystem::path folder) : folder_(std::move(folder)) {}

    /// Empty labels where there is no file. Fails, with the file and what to do, on one that cannot be read.
    Expected<model::Labels> load(const std::string& board) const;
    /// Returns when they are on the disk. A file that load() cannot read, or could
    /// not, is put aside first, as BOARD.json.damaged (.damaged-2 to .damaged-9 where there is one); its new
    /// path is returned, else an empty one. Fails with the file and the reason.
    Expected<std::filesystem::path> save(const std::string& board, const LabelsToKeep& keep) const;

  private:
    std::filesystem::path file(const std::string& board) const;
    Expected<std::filesystem::path> set_aside(const std::string& board, bool unknown) const;

    std::filesystem::path folder_;
};

}  // namespace asip::agent
