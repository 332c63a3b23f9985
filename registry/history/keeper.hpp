// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <boost/asio/io_context.hpp>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "registry/history/disk_thread.hpp"
#include "registry/history/journal.hpp"
#include "registry/history/kept_time.hpp"
#include "registry/history/store.hpp"

namespace asip::registry {

/// Keeps a history beside a catalogue: one thread writes the file, another reads it, so that a slow disk or
/// query never delays the bus, nor a disk that stalls a query. A file that cannot be used is tried again, at
/// first after a second, in the end each minute; meanwhile rows wait and queries are refused. All functions
/// and handlers are of the io_context's thread.
class HistoryKeeper {
  public:
    using Found = std::function<void(bus::Answer)>;
    struct Handlers {
        /// The file cannot be used. Not called again before `works_again`.
        std::function<void(const std::string& reason)> failed;
        /// `lost`: rows for which there was no room meanwhile.
        std::function<void(std::size_t lost)> works_again;
        /// A damaged file was put aside, and a new one begun.
        std::function<void(const std::string& aside, const std::string& damage)> begun_anew;
    };

    /// How far writing may fall behind, beside History::Options::max_waiting_rows; changes beyond are dropped
    /// and counted.
    static constexpr std::size_t kMaxUnwrittenBytes = 96u << 20;
    static constexpr Duration kFirstRetry = std::chrono::seconds(1);
    static constexpr Duration kMaxRetry = std::chrono::minutes(1);
    static constexpr Duration kPatience = std::chrono::seconds(1);

    /// Reads what is known of each board before it returns, where the file can be read. `io` outlives this.
    HistoryKeeper(boost::asio::io_context& io, History::Options options, Handlers handlers, std::string boot,
                  Instant now);
    /// Writes what waits.
    ~HistoryKeeper();
    HistoryKeeper(const HistoryKeeper&) = delete;
    HistoryKeeper& operator=(const HistoryKeeper&) = delete;

    /// For Catalogue::Options::remembered.
    std::optional<Catalogue::Remembered> remembered(std::string_view board, Instant now) const;

    void begin_reading();
    void complete(const Catalogue& catalogue, Instant now);
    void change(const Event& event, Instant now);
    /// What an agent published of a command, ROOT/servicebus/BOARD/$commands. Any bytes may be given.
    void command(std::string_view board, std::string_view payload, Instant now);
    /// Call a few times a second.
    void tick(const Catalogue& catalogue, Instant now);

    /// `found` is called later, with a page or a refusal ("invalid", "history-fault"). What happened before
    /// is in it, unless the disk takes longer than kPatience for that.
    void find(bus::Query query, Found found);

    std::size_t dropped_rows() const { return dropped_rows_; }
    /// Why the file cannot be used now; empty: it can.
    const std::string& fault() const { return fault_; }

  private:
    using Done = std::function<void(const HistoryStore::Outcome&)>;
    struct Batch {
        std::shared_ptr<Journal::Rows> rows;
        std::size_t bytes = 0;
    };

    struct Question {
        bus::Query query;
        Found found;
        Time until;
    };

    void run(HistoryStore::Use use, Done done);
    void read(Question question);
    void open_to_read();
    void read_by_writer(Question question);
    void read_waiting(bool all);
    bool take(const HistoryStore::Outcome& outcome);
    void load(const HistoryStore::Opened& opened);
    void fail(const std::string& reason);
    void try_again();
    void recovered();
    void write_waiting();
    void restore_boards();
    void written(std::uint64_t attempt, const HistoryStore::Outcome& outcome);
    void limit_waiting();
    Stamp stamp() const { return {now_.wall, kept_.at(now_.time)}; }

    boost::asio::io_context& io_;
    Handlers handlers_;
    const std::size_t max_waiting_rows_;
    std::unique_ptr<HistoryStore> store_;  // used by the other thread only, once the constructor is done
    Instant now_;
    KeptTime kept_;
    KeptTime::Milliseconds began_{};  // kept time when this began
    Journal journal_;
    Journal::Rows waiting_;
    std::size_t counted_rows_ = 0;  // of waiting_, in waiting_bytes_
    std::size_t waiting_bytes_ = 0;
    std::deque<Batch> writing_;  // handed to the other thread
    std::uint64_t attempt_ = 0;  // outcomes of an earlier one have been dealt with
    std::size_t dropped_rows_ = 0;
    std::size_t dropped_before_ = 0;  // when the file was in order
    std::string fault_;
    bool trying_ = false;
    bool loaded_ = false;  // what the file knows is in the journal
    Duration retry_ = kFirstRetry;
    Time next_try_{};
    Time next_write_{};
    Time next_trim_{};
    Time next_mark_{};
    std::optional<Time> absent_after_;
    std::deque<Question> asked_;     // until what happened before them is written
    std::unique_ptr<History> read_;  // of the thread that reads
    DiskThread reading_;
    DiskThread thread_;  // last: ends first
};

}  // namespace asip::registry
