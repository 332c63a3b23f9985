// SPDX-License-Identifier: Apache-2.0
// How a value was: rows of one property, stretch by stretch and part by part.
#include <algorithm>

#include "asip/bus/pattern.hpp"
#include "registry/values/value_blocks.hpp"
#include "registry/values/value_file.hpp"
#include "registry/values/value_points.hpp"

namespace asip::registry {
namespace {

/// Gives the pieces of one stretch, in which a value holds until the next.
class StretchPieces {
  public:
    StretchPieces(ValuePoints& points, const Stretch& stretch, Tick until)
        : points_(points), stretch_(stretch), until_(std::min(stretch.end, until)) {}

    void change(const Change& change) {
        hold(change.at);
        value_ = change.value;
    }
    /// `length`: of the bucket.
    void bucket(const Bucket& bucket, Tick length) {
        hold(bucket.at);
        const Tick end = std::min(bucket.at - bucket.at % length + length, until_);
        value_ = bucket.last;
        at_ = std::max(at_, end);
        const auto whole = static_cast<double>(std::max<Tick>(1, end - bucket.at));
        if (bucket.known > 0)
            give(bucket.at, end, bucket.min, bucket.mean, bucket.max,
                 std::min(1.0, static_cast<double>(bucket.known) / whole));
    }
    /// Nothing follows.
    void end() { hold(until_); }

  private:
    void hold(Tick to) {
        to = std::min(to, until_);
        if (to > at_) give(at_, to, value_, value_, value_, 1);
        at_ = std::max(at_, to);
    }
    void give(Tick from, Tick to, double min, double mean, double max, double known) {
        if (!std::isnan(mean)) points_.add(stretch_.shown(from), stretch_.shown(to), min, mean, max, known);
    }

    ValuePoints& points_;
    const Stretch& stretch_;
    Tick until_;
    Tick at_ = 0;
    double value_ = kGap;
};

/// What is kept of one property at one level.
class LevelRows {
  public:
    LevelRows(Database& database, Level level, std::int64_t property)
        : level_(level),
          property_(property),
          rows_(database, (level == Level::kChanges
                               ? "SELECT at,block FROM changes"
                               : "SELECT at,min,mean,max,last,known FROM " + std::string(to_text(level))) +
                              " WHERE part=? AND property=? AND at>=? AND at<? ORDER BY at") {}

    /// What is from `least` on, in the parts of `begin` to `end`, and before `end`: a part holds all that is
    /// needed of its time.
    void give(StretchPieces& pieces, Tick least, Tick begin, Tick end) {
        for (Tick part = begin / part_ticks(level_); part * part_ticks(level_) < end; ++part) {
            const Tick first = part * part_ticks(level_);
            rows_.reset().bind(part).bind(property_);
            rows_.bind(std::max<Tick>(0, least - first)).bind(end - first);
            while (rows_.step())
                give_row(pieces, first + rows_.integer(0));
        }
    }

  private:
    void give_row(StretchPieces& pieces, Tick at) {
        if (level_ == Level::kChanges)
            unpack_changes(rows_.bytes(1), at, [&](const Change& change) { pieces.change(change); });
        else
            pieces.bucket({at, rows_.real(1), rows_.real(2), rows_.real(3), rows_.real(4), rows_.integer(5)},
                          bucket_ticks(level_));
    }

    Level level_;
    std::int64_t property_;
    Statement rows_;
};

bus::Answer value_answer() {
    bus::Answer answer;
    answer.find = bus::Find::kValues;
    return answer;
}

}  // namespace

std::vector<Stretch> ValueFile::stretches(const Stretch& present) {
    std::vector<Stretch> result;
    Statement rows(database_, "SELECT start,until,shift FROM stretches ORDER BY start");
    while (rows.step()) {
        const Stretch each{rows.integer(0), rows.integer(1), rows.integer(2)};
        result.push_back(each.start == present.start ? present : each);
    }
    return result;
}

/// Whether a level has all that happened since then.
bool ValueFile::reaches(Level level, Tick since, const std::vector<Stretch>& stretches) {
    const auto first = oldest(level);
    return first && (first->part * part_ticks(level) + first->whole <= since ||
                     (first->whole == 0 && first->part <= stretches.front().start / part_ticks(level)));
}

/// The finest one that is kept since then, and not finer than the points.
Level ValueFile::level_for(const bus::Query& query, const std::vector<Stretch>& stretches) {
    const auto from = query.from.time_since_epoch().count();
    const auto width = (query.to.time_since_epoch().count() - from) / static_cast<std::int64_t>(query.limit);
    Tick since = stretches.empty() ? 0 : stretches.back().start;
    for (auto each = stretches.rbegin(); each != stretches.rend(); ++each)
        if (each->shown(each->end) > from) since = std::max(each->start, from - each->offset);
    for (const auto level : {Level::kChanges, Level::kMinutes}) {
        if (width >= kBucketTicks[static_cast<std::size_t>(level) + 1]) continue;
        if (reaches(level, since, stretches)) return level;
    }
    return Level::kHours;
}

bus::Answer ValueFile::names(const bus::Query& query) {
    auto answer = value_answer();
    // "BOARD/PROPERTY", the last one of the page before
    const auto slash = std::min(query.cursor.find('/'), query.cursor.size());
    const auto limit = std::clamp<std::size_t>(query.limit, 1, bus::Query::kMaxPage);
    Statement rows(
        database_,
        "SELECT board,property FROM properties WHERE (board,property)>(?,?) ORDER BY board,property");
    rows.bind(query.cursor.substr(0, slash))
        .bind(query.cursor.substr(std::min(slash + 1, query.cursor.size())));
    while (rows.step()) {
        if (!bus::matches_pattern(query.board, rows.text(0))) continue;
        if (answer.kept.size() == limit) {
            answer.cursor = answer.kept.back().board + "/" + answer.kept.back().property;
            break;
        }
        answer.kept.push_back({rows.text(0), rows.text(1)});
    }
    return answer;
}

bus::Answer ValueFile::find(const bus::Query& query, const Stretch& present) {
    if (query.property.empty()) return names(query);
    auto answer = value_answer();
    const auto from = query.from.time_since_epoch().count(), to = query.to.time_since_epoch().count();
    const auto all = stretches(present);
    Statement known(database_, "SELECT id FROM properties WHERE board=? AND property=?");
    known.bind(query.board).bind(query.property);
    if (!known.step()) return answer;
    const auto level = level_for(query, all);
    answer.level = to_text(level);
    ValuePoints points(from, to, query.limit);
    LevelRows rows(database_, level, known.integer(0));
    for (const auto& stretch : all) {
        if (stretch.shown(stretch.end) <= from || stretch.shown(stretch.start) >= to) continue;
        const Tick first = std::max(stretch.start, from - stretch.offset);
        const Tick until = std::min(stretch.end, to - stretch.offset);
        StretchPieces pieces(points, stretch, until);
        // An hour is written each five minutes until it is over, its minutes each ten seconds.
        const Tick hour = stretch.end - stretch.end % kHourTicks;
        const bool by_minutes = level == Level::kHours && stretch.start == present.start && first < hour &&
                                hour < until && reaches(Level::kMinutes, hour, all);
        rows.give(pieces, stretch.start, first, by_minutes ? hour : until);
        if (by_minutes)
            LevelRows(database_, Level::kMinutes, known.integer(0)).give(pieces, hour, hour, until);
        pieces.end();
    }
    answer.values = points.points();
    return answer;
}

}  // namespace asip::registry
