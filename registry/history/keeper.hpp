// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <boost/asio/io_context.hpp>
#include <boost/asio/thread_pool.hpp>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "registry/history/history.hpp"
#include "registry/history/journal.hpp"

namespace asip::registry {

/// Keeps a history beside a catalogue: a thread of its own reads and writes the file, so that a slow disk or
/// query never delays the bus. All functions and handlers are of the io_context's thread.
class HistoryKeeper {
  public:
    using Found = std::function<void(bus::Answer)>;
    /// The file cannot be used any more: nothing is written from then on, and queries are refused.
    using Failed = std::function<void(const std::string& reason)>;

    /// How far writing may fall behind; changes beyond are dropped and counted.
    static constexpr std::size_t kMaxUnwrittenRows = 200'000;
    static constexpr std::size_t kMaxWaitingQueries = 64;

    /// Reads what is known of each board before it returns. Throws as History does. `io` outlives this.
    HistoryKeeper(boost::asio::io_context& io, History::Options options, Failed failed);
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

    /// `found` is called later, with a page or a refusal ("invalid", "no-history", "too-many").
    void find(bus::Query query, Found found);

    std::size_t dropped_rows() const { return dropped_rows_; }

  private:
    void write_waiting();
    /// Runs `work` on the other thread and `done` back on this one, unless `work` threw: then history ends.
    template <class Work, class Done>
    void run(Work work, Done done);
    void fail(const std::string& reason);
    void limit_waiting();

    boost::asio::io_context& io_;
    Failed failed_;
    std::unique_ptr<History> history_;  // used by the other thread only, once the constructor is done
    Journal journal_;
    Journal::Rows waiting_;
    std::size_t unwritten_rows_ = 0;  // handed to the other thread
    std::size_t waiting_queries_ = 0;
    std::size_t dropped_rows_ = 0;
    Time next_write_{};
    Time next_trim_{};
    std::optional<Time> absent_after_;
    bool usable_ = true;
    boost::asio::thread_pool thread_{1};  // last: ends first
};

}  // namespace asip::registry
