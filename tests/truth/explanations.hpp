// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

namespace truth {

/// A request as the board read it.
struct ReadRequest {
    std::string line;  ///< without checksum and line end
    int error = -1;    ///< what the board answered with, or less than 0
};

/// Whether the same errors in the same order, on other requests of the batch that they could belong to, give
/// the same digest: a session cannot know then which request failed. It happens by chance, as a digest has 16
/// bits.
bool explained_twice(const std::vector<ReadRequest>& batch);

}  // namespace truth
