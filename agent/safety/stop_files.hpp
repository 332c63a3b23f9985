// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <optional>
#include <string>

#include "asip/expected.hpp"
#include "asip/model/description.hpp"

namespace asip::agent {

/// Stops that hold, on the disk: FOLDER/stopped/BOARD.json, which is there as long as the board is stopped.
/// Not a retained message: that would be gone with a broker that keeps nothing, and the robot would drive on.
class StopFiles {
  public:
    /// `folder` is made with the first file. Empty: nothing can be kept.
    explicit StopFiles(std::filesystem::path folder) : folder_(std::move(folder)) {}

    /// Nothing where there is no file. Fails, with the file and the reason, on one that cannot be read.
    Expected<std::optional<model::StopInfo>> load(const std::string& board) const;
    /// Returns when it is on the disk. Nothing removes the file.
    Expected<void> save(const std::string& board, const std::optional<model::StopInfo>& stopped) const;

  private:
    std::filesystem::path file(const std::string& board) const;

    std::filesystem::path folder_;
};

}  // namespace asip::agent
