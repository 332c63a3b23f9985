// SPDX-License-Identifier: Apache-2.0
// Queries over the history: bounded by the rows looked at, not by the rows there are.
#include <algorithm>
#include <deque>

#include "asip/bus/pattern.hpp"
#include "registry/history/history.hpp"
#include "registry/history/statement.hpp"

namespace asip::registry {
namespace {

constexpr std::size_t kMaxSources = 64;  // boards whose changes are read side by side
constexpr std::size_t kMaxNamesPerQuery = 100'000;
constexpr const char* kSelect =
    "SELECT id,at,board,what,state,was,reason,sender,service,request,status,count FROM changes WHERE ";

// Rows of several statements, each with falling ids, as one sequence with falling ids.
class MergedRows {
  public:
    explicit MergedRows(std::deque<Statement> sources) {
        for (Statement& source : sources)
            if (source.step()) sources_.push_back(std::move(source));
    }
    bool at_end() const { return sources_.empty(); }
    /// The row with the highest id. Not at the end.
    const Statement& front() const { return sources_[newest()]; }
    void pop() {
        const auto source = sources_.begin() + static_cast<std::ptrdiff_t>(newest());
        if (!source->step()) sources_.erase(source);
    }

  private:
    std::size_t newest() const {
        std::size_t best = 0;
        for (std::size_t i = 1; i < sources_.size(); ++i)
            if (sources_[i].integer(0) > sources_[best].integer(0)) best = i;
        return best;
    }
    std::deque<Statement> sources_;
};

// The names that a pattern matches; nothing where they are too many to be read side by side.
std::optional<std::vector<std::string>> names_matching(sqlite3* database, const std::string& pattern) {
    const std::string prefix = pattern.substr(0, pattern.find_first_of("*?"));
    if (prefix == pattern) return std::vector<std::string>{pattern};
    Statement rows(database, "SELECT name FROM boards WHERE name>=? ORDER BY name");
    rows.bind(prefix);
    std::vector<std::string> names;
    for (std::size_t seen = 0; rows.step(); ++seen) {
        std::string name = rows.text(0);
        if (name.compare(0, prefix.size(), prefix) != 0) break;
        if (seen == kMaxNamesPerQuery || names.size() > kMaxSources) return std::nullopt;
        if (bus::matches_pattern(pattern, name)) names.push_back(std::move(name));
    }
    if (names.size() > kMaxSources) return std::nullopt;
    return names;
}

std::deque<Statement> sources_for(sqlite3* database, const bus::Query& query, std::int64_t before) {
    std::deque<Statement> sources;
    const auto add = [&](const char* column, const std::vector<std::string>& values) {
        const std::string sql = std::string(kSelect) + column + "=? AND id<? ORDER BY id DESC";
        for (const std::string& value : values)
            sources.emplace_back(database, sql).bind(value).bind(before);
    };
    if (!query.board.empty()) {
        if (const auto names = names_matching(database, query.board)) {
            add("board", *names);
            return sources;
        }
    }
    if (!query.state.empty()) {
        std::vector<std::string> states = query.state;
        std::sort(states.begin(), states.end());
        states.erase(std::unique(states.begin(), states.end()), states.end());
        add("state", states);
    } else {
        sources.emplace_back(database, std::string(kSelect) + "id<? ORDER BY id DESC").bind(before);
    }
    return sources;
}

std::optional<std::int64_t> read_cursor(const std::string& text) {
    if (text.empty()) return INT64_MAX;
    if (text.size() > 18 || text.find_first_not_of("0123456789") != std::string::npos) return std::nullopt;
    return std::stoll(text);
}

// Every cursor is the number of a row that was there, and the oldest are dropped first.
bool is_beyond(sqlite3* database, std::int64_t cursor) {
    Statement newest(database, "SELECT id FROM changes ORDER BY id DESC LIMIT 1");
    return newest.step() && cursor > newest.integer(0);
}

}  // namespace

Expected<bus::Answer> History::find(const bus::Query& query) {
    const auto before = read_cursor(query.cursor);
    if (!before || (!query.cursor.empty() && is_beyond(database_, *before)))
        return fail("cursor: not one of this registry's");
    for (const std::string& word : query.state)
        if (!model::board_state_from_text(word))
            return fail("state: \"" + word + "\" is none of online, offline, lost, sleeping, updating");
    bus::Answer answer;
    answer.find = bus::Find::kHistory;
    const std::size_t limit = std::clamp<std::size_t>(query.limit, 1, bus::Query::kMaxPage);
    MergedRows rows(sources_for(database_, query, *before));
    std::int64_t last = 0;
    for (std::size_t looked_at = 0; !rows.at_end(); ++looked_at, rows.pop()) {
        if (answer.history.size() == limit || looked_at == kMaxRowsPerQuery) {
            answer.cursor = std::to_string(last);
            break;
        }
        const Statement& row = rows.front();
        last = row.integer(0);
        bus::HistoryItem item{row.text(2),
                              text::WallTime(std::chrono::milliseconds(row.integer(1))),
                              row.text(3),
                              row.text(4),
                              row.text(5),
                              row.text(6),
                              row.text(7),
                              row.text(8),
                              row.text(9),
                              row.text(10),
                              static_cast<int>(row.integer(11))};
        const bool wanted = query.state.empty() || std::find(query.state.begin(), query.state.end(),
                                                             item.state) != query.state.end();
        if (wanted && bus::matches_pattern(query.board, item.board))
            answer.history.push_back(std::move(item));
    }
    return answer;
}

}  // namespace asip::registry
