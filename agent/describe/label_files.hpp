// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <string>

#include "agent/bridge/effects.hpp"
#include "asip/expected.hpp"
#include "asip/model/labels.hpp"

namespace asip::agent {

/// Where an agent keeps its state by default: $STATE_DIRECTORY (of systemd), $XDG_STATE_HOME/asip, or
/// ~/.local/state/asip; empty: there is no such place.
std::filesystem::path default_state_folder();

/// Labels on the disk: FOLDER/labels/BOARD.json. A file is whole or unchanged, whenever program or machine
/// dies.
class LabelFiles {
  public:
    /// Empty: nothing can be kept.
    explicit LabelFiles(std::filesystem::path folder) : folder_(std::move(folder)) {}

    /// Empty labels where there is no file. Fails, with the file and what to do, where it cannot be read.
    Expected<model::Labels> load(const std::string& board) const;
    /// Returns when they are on the disk. A file that load() cannot read is put aside first, as
    /// BOARD.json.damaged (.damaged-2 to .damaged-9); its new path is returned, else an empty one. Fails with
    /// file and reason.
    Expected<std::filesystem::path> save(const std::string& board, const LabelsToKeep& keep) const;

  private:
    std::filesystem::path file(const std::string& board) const;
    Expected<std::filesystem::path> set_aside(const std::string& board, bool unknown) const;

    std::filesystem::path folder_;
};

}  // namespace asip::agent
