// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <optional>
#include <string>

#include "asip/expected.hpp"
#include "asip/model/description.hpp"

namespace asip::agent {

/// Stops on the disk: FOLDER/stopped/BOARD.json exists while the board is stopped. A retained message would
/// be gone with a broker that stores nothing, and the robot would drive on.
class StopFiles {
  public:
    /// Empty: nothing can be kept.
    explicit StopFiles(std::filesystem::path folder) : folder_(std::move(folder)) {}

    /// Nothing: there is no file. Fails where it cannot be read.
    Expected<std::optional<model::StopInfo>> load(const std::string& board) const;
    /// Returns when the file is on the disk; nothing deletes it.
    Expected<void> save(const std::string& board, const std::optional<model::StopInfo>& stopped) const;

  private:
    std::filesystem::path file(const std::string& board) const;

    std::filesystem::path folder_;
};

}  // namespace asip::agent
