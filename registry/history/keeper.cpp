// SPDX-License-Identifier: Apache-2.0
#include "registry/history/keeper.hpp"

#include <boost/asio/post.hpp>
#include <exception>

namespace asip::registry {
namespace {

namespace asio = boost::asio;

constexpr Duration kWriteInterval = std::chrono::seconds(1);
constexpr Duration kTrimInterval = std::chrono::minutes(1);
// Boards that take part by names only renew a lease of 60 s.
constexpr Duration kAbsentAfter = std::chrono::seconds(90);

Time monotonic(text::WallTime wall, Instant now) {
    return now.time - std::chrono::duration_cast<Duration>(now.wall - wall);
}

bus::Answer refused_page(std::string reason, std::string error) {
    bus::Answer answer;
    answer.refused = std::move(reason);
    answer.error = std::move(error);
    return answer;
}

}  // namespace

HistoryKeeper::HistoryKeeper(asio::io_context& io, History::Options options, Failed failed)
    : io_(io),
      failed_(std::move(failed)),
      history_(std::make_unique<History>(std::move(options))),
      journal_(history_->boards()) {}

HistoryKeeper::~HistoryKeeper() {
    write_waiting();
    thread_.join();
}

template <class Work, class Done>
void HistoryKeeper::run(Work work, Done done) {
    asio::post(thread_, [this, work = std::move(work), done = std::move(done)]() mutable {
        try {
            asio::post(io_, [result = work(*history_), done = std::move(done)]() mutable {
                done(std::move(result));
            });
        } catch (const std::exception& error) {
            asio::post(io_, [this, reason = std::string(error.what())] { fail(reason); });
        }
    });
}

std::optional<Catalogue::Remembered> HistoryKeeper::remembered(std::string_view board, Instant now) const {
    const JournalBoard* known = journal_.find(board);
    if (known == nullptr) return std::nullopt;
    return Catalogue::Remembered{monotonic(known->first, now), known->state, monotonic(known->since, now)};
}

void HistoryKeeper::begin_reading() {
    journal_.begin_reading();
    absent_after_.reset();
}

void HistoryKeeper::complete(const Catalogue& catalogue, Instant now) {
    journal_.complete(catalogue, now.wall, waiting_);
    limit_waiting();
    absent_after_ = now.time + kAbsentAfter;
}

void HistoryKeeper::change(const Event& event, Instant now) {
    journal_.change(event, now.wall, waiting_);
    limit_waiting();
}

void HistoryKeeper::command(std::string_view board, std::string_view payload, Instant now) {
    journal_.command(board, payload, now.wall, waiting_);
    limit_waiting();
}

void HistoryKeeper::limit_waiting() {
    const std::size_t room = kMaxUnwrittenRows - std::min(kMaxUnwrittenRows, unwritten_rows_);
    if (!usable_ || waiting_.size() <= room) return;
    dropped_rows_ += waiting_.size() - room;
    waiting_.resize(room);
}

void HistoryKeeper::tick(const Catalogue& catalogue, Instant now) {
    if (absent_after_ && now.time >= *absent_after_) {
        absent_after_.reset();
        journal_.end_absent(catalogue, now.wall, waiting_);
    }
    if (now.time >= next_write_) {
        write_waiting();
        next_write_ = now.time + kWriteInterval;
    }
    if (usable_ && now.time >= next_trim_) {
        run([wall = now.wall](History& history) { return history.trim(wall), true; }, [](bool) {});
        next_trim_ = now.time + kTrimInterval;
    }
}

void HistoryKeeper::write_waiting() {
    Journal::Rows rows = std::move(waiting_);
    waiting_.clear();
    if (rows.empty() || !usable_) return;
    const std::size_t count = rows.size();
    unwritten_rows_ += count;
    run([rows = std::move(rows)](History& history) { return history.write(rows), true; },
        [this, count](bool) { unwritten_rows_ -= count; });
}

void HistoryKeeper::find(bus::Query query, Found found) {
    if (!usable_) {
        return found(
            refused_page("no-history", "the history cannot be written and was given up; see the log"));
    }
    if (waiting_queries_ == kMaxWaitingQueries) {
        return found(
            refused_page("too-many", "too many queries of the history wait already; ask again later"));
    }
    write_waiting();
    ++waiting_queries_;
    run([query = std::move(query)](History& history) { return history.find(query); },
        [this, found = std::move(found)](Expected<bus::Answer> answer) {
            --waiting_queries_;
            found(answer ? std::move(*answer) : refused_page("invalid", answer.error()));
        });
}

void HistoryKeeper::fail(const std::string& reason) {
    if (!usable_) return;
    usable_ = false;
    waiting_.clear();
    failed_(reason);
}

}  // namespace asip::registry
