// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "asip/expected.hpp"
#include "gateway/commands/commands.hpp"
#include "gateway/http/server.hpp"
#include "gateway/metrics/command_times.hpp"
#include "gateway/metrics/prometheus_text.hpp"
#include "gateway/mirror/standing.hpp"

namespace asip::gateway::metrics {

/// A part of all boards, the same while their names are: several scrapes take one each.
struct Part {
    std::size_t number = 1, of = 1;

    bool is_first() const { return number == 1; }
    bool takes(std::string_view board) const;
    /// "2/4". Error: a sentence.
    static Expected<Part> parse(std::string_view text);
    static constexpr std::size_t kMaxParts = 100;
};

/// As a number.
struct ValueSample {
    std::string board, property;
    double value = 0;
};

/// All that is shown, as far as the asker may see it. The caller fills it.
struct Snapshot {
    http::ServerCounters server;
    Commands::Counters commands;
    CommandTimes durations;
    bool broker_connected = false;
    std::size_t streams = 0;
    // From Values: since the start, and what is kept now.
    std::uint64_t values_received = 0;
    std::uint64_t values_skipped = 0;  ///< by slow readers
    std::uint64_t values_refused = 0;  ///< that their properties cannot have
    Standing::Counters documents{};    ///< of agents, that count for nothing
    std::size_t values_bytes = 0;
    std::size_t last_values_bytes = 0;
    std::vector<std::pair<std::string, std::size_t>> boards_by_state;
    std::vector<std::pair<std::string, std::size_t>> lost_by_reason;  ///< each reason, also where none is
    std::size_t boards_out_of_date = 0;
    std::vector<std::pair<std::string, std::size_t>> services_by_kind;
    std::vector<std::pair<std::string, std::string>> registries;  ///< id, JSON of its `$stats`
    std::vector<std::pair<std::string, std::string>> boards;      ///< name, JSON of its `$stats`
    Part part{};                        ///< what is not of boards stands in the first part alone
    std::vector<ValueSample> values{};  ///< of services that were asked for
    bool values_left_out = false;       ///< there are more than are shown
    // From the operating system: read_process().
    double resident_bytes = 0;
    double processor_seconds = 0;
    double open_files = 0;
    double started_at = 0;  ///< seconds since 1970
};

/// Beyond so many values of a label the rest is left out, or counted together.
inline constexpr std::size_t kMaxBoards = 2000;
inline constexpr std::size_t kMaxValues = 20'000;
inline constexpr std::size_t kMaxKinds = 100;
inline constexpr std::size_t kMaxOutcomes = 20;

struct Family;

/// Writes a snapshot in one of two formats, in steps of about a millisecond. Statistics of other versions are
/// passed over. Pure.
class Writer {
  public:
    static constexpr std::size_t kRead = 20;      ///< boards whose statistics are read in a step
    static constexpr std::size_t kWritten = 500;  ///< boards, or values, that are written in one
    struct Named {
        std::string name;
        nlohmann::json stats;
    };

    Writer(Snapshot snapshot, Exposition::Format format);
    /// False: that was the last one.
    bool step();
    /// Once, behind the last step.
    std::string text() { return out_.finish(); }

  private:
    void add_family(const Family& family);
    bool add_values();

    Snapshot snapshot_;
    Exposition out_;
    std::vector<Named> boards_;
    bool begun_ = false;
    std::size_t read_ = 0;    // boards
    std::size_t family_ = 0;  // that is written
    std::size_t at_ = 0;      // in it, or in the values
};

struct Family {
    std::string_view name;
    Exposition::Type type;
    std::string_view unit;
    std::string_view help;
    std::function<void(Exposition&, const Writer::Named&)> sample;
};

/// From the operating system.
void read_process(Snapshot& snapshot);

}  // namespace asip::gateway::metrics
