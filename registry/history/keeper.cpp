// SPDX-License-Identifier: Apache-2.0
#include "registry/history/keeper.hpp"

#include <algorithm>
#include <boost/asio/post.hpp>
#include <iterator>
#include <utility>

namespace asip::registry {
namespace {

namespace asio = boost::asio;

constexpr Duration kWriteInterval = std::chrono::seconds(1);
constexpr Duration kTrimInterval = std::chrono::minutes(1);
constexpr Duration kMarkInterval = std::chrono::hours(1);  // a card in a small computer wears out
// Boards that take part by names only renew a lease of 60 s.
constexpr Duration kAbsentAfter = std::chrono::seconds(90);

bus::Answer refused_page(std::string reason, std::string error) {
    bus::Answer answer;
    answer.refused = std::move(reason);
    answer.error = std::move(error);
    return answer;
}

bus::Answer history_fault(const std::string& fault) {
    return refused_page("history-fault", "the history cannot be used now, and is tried again: " + fault);
}

std::size_t bytes_of(const bus::HistoryItem& item) {
    std::size_t bytes = sizeof(item);
    for (const std::string* text : {&item.board, &item.what, &item.state, &item.was, &item.reason, &item.by,
                                    &item.service, &item.request, &item.status}) {
        if (text->size() > 15) bytes += text->capacity() + 1;  // the others are kept within the item
    }
    return bytes;
}

}  // namespace

HistoryKeeper::HistoryKeeper(asio::io_context& io, History::Options options, Handlers handlers,
                             std::string boot, Instant now)
    : io_(io),
      handlers_(std::move(handlers)),
      max_waiting_rows_(options.max_waiting_rows),
      store_(std::make_unique<HistoryStore>(std::move(options))),
      now_(now),
      kept_(std::move(boot), now),
      began_(kept_.at(now.time)),
      journal_({}),
      reading_(store_->options().own_thread),
      thread_(store_->options().own_thread) {
    if (!take(store_->run([](History&, const auto*) {}))) return;
    reading_.post([this] {
        try {
            open_to_read();                // before the disk may stall
        } catch (const std::exception&) {  // the first question says why
        }
    });
}

HistoryKeeper::~HistoryKeeper() {
    if (!fault_.empty() && loaded_) {  // it may have passed by now
        thread_.post([this] { store_->retry(); });
        fault_.clear();
    }
    write_waiting();
    if (loaded_ && fault_.empty()) {
        run([mark = kept_.mark(now_)](History& history, const auto*) { history.write({}, mark); },
            [](const auto&) {});
    }
    thread_.join();
    reading_.join();
}

void HistoryKeeper::run(HistoryStore::Use use, Done done) {
    thread_.post([this, use = std::move(use), done = std::move(done)]() mutable {
        asio::post(io_, [outcome = store_->run(use), done = std::move(done)] { done(outcome); });
    });
}

// True: the file is in order.
bool HistoryKeeper::take(const HistoryStore::Outcome& outcome) {
    if (outcome.opened) load(*outcome.opened);
    if (!outcome.fault.empty()) fail(outcome.fault);
    return outcome.fault.empty();
}

void HistoryKeeper::load(const HistoryStore::Opened& opened) {
    reading_.post([this] { read_.reset(); });  // it may hold the file of before
    if (!opened.aside.empty() && handlers_.begun_anew) handlers_.begun_anew(opened.aside, opened.damage);
    if (loaded_) {
        if (opened.made) restore_boards();
        return;
    }
    loaded_ = true;
    const auto before = kept_.at(now_.time);
    kept_.load(opened.mark, now_);
    const auto shift = kept_.at(now_.time) - before;
    began_ += shift;
    journal_.load(opened.boards, shift, waiting_);
    counted_rows_ = waiting_bytes_ = 0;
    limit_waiting();
}

void HistoryKeeper::fail(const std::string& reason) {
    const bool first = retry_ == kFirstRetry;
    if (first) dropped_before_ = dropped_rows_;
    ++attempt_;
    for (auto batch = writing_.rbegin(); batch != writing_.rend(); ++batch) {
        waiting_.insert(waiting_.begin(), std::move_iterator(batch->rows->begin()),
                        std::move_iterator(batch->rows->end()));
        counted_rows_ += batch->rows->size();
        waiting_bytes_ += batch->bytes;
    }
    writing_.clear();
    limit_waiting();
    reading_.post([this] { read_.reset(); });  // the file may be another one then
    fault_ = reason;
    read_waiting(true);
    next_try_ = now_.time + retry_;
    retry_ = std::min(2 * retry_, kMaxRetry);
    if (first && handlers_.failed) handlers_.failed(reason);
}

void HistoryKeeper::try_again() {
    trying_ = true;
    thread_.post([this] { store_->retry(); });
    run([](History& history, const auto*) { history.try_writing(); },
        [this](const auto& outcome) {
            trying_ = false;
            if (!take(outcome)) return;
            fault_.clear();
            // What was known of boards may be newer than what the file was given.
            if (dropped_rows_ != dropped_before_) restore_boards();
            write_waiting();
            if (writing_.empty()) recovered();
        });
}

void HistoryKeeper::recovered() {
    if (retry_ == kFirstRetry) return;
    retry_ = kFirstRetry;
    const auto lost = dropped_rows_ - std::exchange(dropped_before_, dropped_rows_);
    if (handlers_.works_again) handlers_.works_again(lost);
}

std::optional<Catalogue::Remembered> HistoryKeeper::remembered(std::string_view board, Instant now) const {
    const JournalBoard* known = journal_.find(board);
    if (known == nullptr) return std::nullopt;
    Catalogue::Remembered result;
    result.state = known->state;
    result.age = kept_.at(now.time) - known->since_kept;
    if (known->first_kept < began_) result.first_seen = known->first;
    if (known->since_kept < began_) result.since = known->since;
    return result;
}

void HistoryKeeper::begin_reading() {
    journal_.begin_reading();
    absent_after_.reset();
}

void HistoryKeeper::complete(const Catalogue& catalogue, Instant now) {
    now_ = now;
    journal_.complete(catalogue, stamp(), waiting_);
    limit_waiting();
    absent_after_ = now.time + kAbsentAfter;
}

void HistoryKeeper::change(const Event& event, Instant now) {
    now_ = now;
    journal_.change(event, stamp(), waiting_);
    limit_waiting();
}

void HistoryKeeper::command(std::string_view board, std::string_view payload, Instant now) {
    now_ = now;
    journal_.command(board, payload, now.wall, waiting_);
    limit_waiting();
}

void HistoryKeeper::limit_waiting() {
    std::size_t rows = waiting_.size();
    std::size_t bytes = 0;
    for (const Batch& batch : writing_) {
        rows += batch.rows->size();
        bytes += batch.bytes;
    }
    for (; counted_rows_ < waiting_.size(); ++counted_rows_)
        waiting_bytes_ += bytes_of(waiting_[counted_rows_]);
    for (; !waiting_.empty() && (rows > max_waiting_rows_ || bytes + waiting_bytes_ > kMaxUnwrittenBytes);
         --rows, --counted_rows_, ++dropped_rows_) {
        waiting_bytes_ -= std::min(waiting_bytes_, bytes_of(waiting_.back()));
        waiting_.pop_back();
    }
}

void HistoryKeeper::tick(const Catalogue& catalogue, Instant now) {
    now_ = now;
    kept_.tick(now);
    read_waiting(false);
    if (loaded_ && absent_after_ && now.time >= *absent_after_) {
        absent_after_.reset();
        journal_.end_absent(catalogue, stamp(), waiting_);
        limit_waiting();
    }
    if (!fault_.empty()) {
        if (!trying_ && now.time >= next_try_) try_again();
        return;
    }
    if (now.time >= next_write_) {
        write_waiting();
        next_write_ = now.time + kWriteInterval;
    }
    if (now.time >= next_trim_) {
        run([kept = kept_.at(now.time)](History& history, const auto*) { history.trim(kept); },
            [this, attempt = attempt_](const auto& outcome) {
                if (attempt == attempt_) take(outcome);
            });
        next_trim_ = now.time + kTrimInterval;
    }
}

void HistoryKeeper::write_waiting() {
    if (!fault_.empty() || !loaded_ || (waiting_.empty() && now_.time < next_mark_)) return;
    next_mark_ = now_.time + kMarkInterval;
    auto rows = std::make_shared<Journal::Rows>(std::exchange(waiting_, {}));
    counted_rows_ = 0;
    writing_.push_back({rows, std::exchange(waiting_bytes_, 0)});
    run([rows, mark = kept_.mark(now_)](History& history, const auto*) { history.write(*rows, mark); },
        [this, attempt = attempt_](const auto& outcome) { written(attempt, outcome); });
}

void HistoryKeeper::written(std::uint64_t attempt, const HistoryStore::Outcome& outcome) {
    if (attempt != attempt_ || !take(outcome)) return;
    writing_.pop_front();
    if (writing_.empty()) recovered();
    read_waiting(writing_.empty());
}

// A new file, or one that missed changes, knows the boards again.
void HistoryKeeper::restore_boards() {
    run([boards = journal_.boards()](History& history, const auto*) { history.write_boards(boards); },
        [this, attempt = attempt_](const auto& outcome) {
            if (attempt == attempt_) take(outcome);
        });
}

void HistoryKeeper::find(bus::Query query, Found found) {
    if (fault_.empty()) write_waiting();
    asked_.push_back({std::move(query), std::move(found), now_.time + kPatience});
    read_waiting(writing_.empty());
}

void HistoryKeeper::read_waiting(bool all) {
    for (auto due = std::exchange(asked_, {}); !due.empty(); due.pop_front()) {
        auto& question = due.front();
        if (!fault_.empty())
            question.found(history_fault(fault_));
        else if (all || now_.time >= question.until)
            read(std::move(question));
        else
            asked_.push_back(std::move(question));
    }
}

void HistoryKeeper::read(Question question) {
    reading_.post([this, question = std::move(question)]() mutable {
        Expected<bus::Answer> page = asip::fail("");
        bool whole = true;
        try {
            open_to_read();
            page = read_->find(question.query);
        } catch (const std::exception&) {
            read_.reset();
            whole = false;
        }
        asio::post(io_, [this, whole, page = std::move(page), question = std::move(question)]() mutable {
            if (!whole) return read_by_writer(std::move(question));
            question.found(page ? std::move(*page) : refused_page("invalid", page.error()));
        });
    });
}

void HistoryKeeper::open_to_read() {
    if (!read_) read_ = std::make_unique<History>(store_->options());
}

/// It says what is wrong, and begins a damaged file anew.
void HistoryKeeper::read_by_writer(Question question) {
    auto answer = std::make_shared<Expected<bus::Answer>>(asip::fail(""));
    run([query = std::move(question.query), answer](History& history,
                                                    const auto*) { *answer = history.find(query); },
        [this, answer, found = std::move(question.found), attempt = attempt_](const auto& outcome) {
            if (!outcome.fault.empty()) {
                if (attempt == attempt_) take(outcome);
                return found(history_fault(outcome.fault));
            }
            if (outcome.opened) take(outcome);
            found(*answer ? std::move(**answer) : refused_page("invalid", answer->error()));
        });
}

}  // namespace asip::registry
