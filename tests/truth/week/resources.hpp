// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <fmt/format.h>
#include <malloc.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

namespace truth::week {

/// So small that both files are full before the second quarter of a week.
inline constexpr std::size_t kHistoryBytes = 1u << 20, kValuesBytes = 1u << 20;

/// What the programs take, looked at once an hour.
class Resources {
  public:
    struct Look {
        double memory = 0, descriptors = 0, files = 0, history = 0, values = 0;
    };
    Resources(std::filesystem::path folder, unsigned hours) : folder_(std::move(folder)), hours_(hours) {}

    /// As text.
    std::string look() {
        Look now;
        const auto heap = mallinfo2();
        now.memory = static_cast<double>(heap.uordblks + heap.hblkhd);
        for ([[maybe_unused]] const auto& each : std::filesystem::directory_iterator("/proc/self/fd"))
            ++now.descriptors;
        for (const auto& file : std::filesystem::directory_iterator(folder_))
            if (file.is_regular_file()) now.files += static_cast<double>(file.file_size());
        now.history = size_of("history.db");
        now.values = size_of("values.db");
        looks_.push_back(now);
        return fmt::format(
            "{:.0f} bytes of memory, {} descriptors, {:.0f} bytes of history, {:.0f} of values, {:.0f} of "
            "all "
            "files",
            now.memory, now.descriptors, now.history, now.values, now.files);
    }
    Look last() const { return looks_.empty() ? Look() : looks_.back(); }
    /// What is wrong; empty: nothing. The last quarter is as the second one was. In a week the files come to
    /// their bounds.
    std::string judge() const {
        const auto early = max(&Look::memory, 1), late = max(&Look::memory, 3);
        // The caches of SQLite are full after a day.
        if (late > early * (hours_ < 24 ? 1.05 : 1.01))
            return fmt::format("{:.0f} bytes of memory became {:.0f}", early, late);
        if (max(&Look::descriptors, 3) > max(&Look::descriptors, 1)) return "descriptors became more";
        constexpr double kLogs = 8u << 20;  // of what is not in the files yet
        for (const auto& look : looks_)
            if (look.files > kHistoryBytes + kValuesBytes + kLogs) return "the files are too large";
        const bool full = last().history > .75 * kHistoryBytes && last().values > .75 * kValuesBytes;
        return hours_ < kWeek || full ? "" : "history or values did not come to their bounds";
    }

  private:
    static constexpr unsigned kWeek = 168;

    double size_of(const char* name) const {
        std::error_code none;
        const auto size = std::filesystem::file_size(folder_ / name, none);
        return none ? 0 : static_cast<double>(size);
    }
    double max(double Look::* member, unsigned quarter) const {
        double found = 0;
        for (auto at = looks_.size() * quarter / 4; at < looks_.size() * (quarter + 1) / 4; ++at)
            found = std::max(found, looks_[at].*member);
        return found;
    }

    const std::filesystem::path folder_;
    const unsigned hours_;
    std::vector<Look> looks_;
};

}  // namespace truth::week
