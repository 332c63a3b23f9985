// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdio>
#include <string>

#include "asip/text/wall_time.hpp"

namespace asip::registry {

inline text::WallTime wall(std::int64_t milliseconds) {
    return text::WallTime(std::chrono::milliseconds(milliseconds));
}

/// The path of a history file of this test; removed before and after.
class HistoryFile {
  public:
    HistoryFile() { clear(); }
    ~HistoryFile() { clear(); }
    const std::string& path() const { return path_; }

  private:
    void clear() {
        for (const char* suffix : {"", "-wal", "-shm"})
            std::remove((path_ + suffix).c_str());
    }
    std::string path_ = testing::TempDir() + "asip-history-" + std::to_string(getpid()) + ".db";
};

}  // namespace asip::registry
