// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "asip/bus/registry/answer.hpp"
#include "asip/bus/registry/query.hpp"
#include "asip/time.hpp"
#include "registry/history/statement.hpp"
#include "registry/values/recorder.hpp"

namespace asip::registry {

/// The values of properties in an SQLite file: each change, minutes and hours, in parts of which the oldest
/// are dropped first, by age and by size. A crash loses what write() was not given yet.
///
/// Blocks while it reads and writes: ValueKeeper uses it from a thread of its own. Each function throws
/// HistoryFault where the file cannot be used.
class ValueFile {
  public:
    struct Options {
        std::string path;
        std::array<Tick, kLevels> max_age{2 * kDayTicks, 90 * kDayTicks, 1826 * kDayTicks};
        std::size_t max_bytes = std::size_t{1} << 30;
        bool own_thread = true;  ///< false: ValueKeeper uses the file in its caller's
    };
    static constexpr std::size_t kMaxNames = 100'000;  ///< of properties that ever had a value
    static constexpr std::size_t kMaxNamesOfBoard = 2'000;

    explicit ValueFile(Options options);

    /// The end of the last stretch.
    std::optional<Tick> last();
    /// In one transaction; drops what is too old, or too much. False: there are too many names, and some rows
    /// were left out.
    bool write(const ValueRows& rows);

    /// Points of a property, in `query.from` to `query.to`, at most `query.limit`. `present`: the stretch
    /// that goes on, which holds further than what is written. Without a `query.property` the properties are
    /// listed that are kept of the board.
    bus::Answer find(const bus::Query& query, const Stretch& present);

  private:
    struct Name {
        std::int64_t id = 0;
        Tick written = 0;  // in a part that begins here
    };
    bool has_room(const std::string& board);
    std::optional<std::int64_t> id_of(const PropertyKey& key, Tick at);
    void write_properties(const ValueRows& rows, bool& all);
    void forget_names() {
        names_.clear();
        count_ = -1;
    }
    /// The oldest part of a level, and since when in it all is there that happened.
    struct Oldest {
        std::int64_t part = 0;
        Tick whole = 0;
    };
    std::optional<Oldest> oldest(Level level);
    void say_whole(Level level, std::int64_t part, Tick since);
    void drop_old(Tick now);
    bool drop_oldest(Level level, Tick now);
    void drop_rows(Level level, std::int64_t part, std::optional<Tick> cut);
    std::vector<Stretch> stretches(const Stretch& present);
    bool reaches(Level level, Tick since, const std::vector<Stretch>& stretches);
    Level level_for(const bus::Query& query, const std::vector<Stretch>& stretches);
    bus::Answer names(const bus::Query& query);

    Options options_;
    Database database_;
    std::map<PropertyKey, Name> names_;  // those that were written
    std::int64_t count_ = -1;            // of all names; negative: not known yet
    Tick dropped_at_ = 0;
};

}  // namespace asip::registry
