// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <queue>
#include <string>
#include <vector>

#include "asip/mqtt/client.hpp"
#include "bench/load/board.hpp"
#include "bench/load/script.hpp"
#include "bench/load/times.hpp"

namespace asip::load {

/// How many boards there are, and how they are connected and announced.
struct FleetOptions {
    /// For each connection; the fleet adds a number to the client identifier, and the will.
    mqtt::Options mqtt;
    std::string topic_root = "asip";
    std::string prefix = "load-";
    std::size_t boards = 100;
    /// 1: each board has a connection of its own, and a will at the broker. More: the boards share
    /// connections.
    std::size_t per_connection = 1;
    int lease_seconds = model::kDefaultLeaseSeconds;
    double values_per_second = 0;  ///< of each board, for each of its services
    bool on_shared_topic = true;   ///< see member::AnnouncerOptions
    std::uint64_t started_unix = 0;
};

/// What happened to boards and connections, counted since the start. A number of boards counts each time that
/// it happens to a board, not each board once.
struct Tally {
    std::uint64_t joined = 0, died = 0, flapped = 0, hung = 0, left = 0;
    std::uint64_t conflicts = 0;  ///< a living agent holds the name
    std::uint64_t connections_made = 0, connections_lost = 0, attempts_failed = 0;
    std::uint64_t descriptions = 0;  ///< announcements that the broker acknowledged, and renewals
    std::uint64_t commands = 0;      ///< that arrived, and were answered where an answer was wanted
    std::uint64_t values = 0;
    /// Messages of all connections, as the MQTT clients count them; `denied`: by the access rules of the
    /// broker.
    std::uint64_t received = 0, published = 0, dropped = 0, refused = 0, denied = 0;
    Times announced;  ///< from the start of an agent, or its return, to its acknowledged description
    Times late;  ///< by how much this program's own timers were late: it, or the machine, is at its limit
};

/// All simulated boards and their connections. With one board a connection each has a will, as agents have.
/// Boards that share a connection have none at the broker: this program publishes what the will would say.
/// One thread: all calls on the thread of `io`. A board that ends stays in its slot, so that its number and
/// its name are the same when it comes back.
class Fleet {
  public:
    /// `kind` and `io` must outlive it. No connection is made before the first join.
    Fleet(boost::asio::io_context& io, FleetOptions options, const BoardKind& kind, Random random);
    ~Fleet();
    // Handlers of connections and timers hold its address.
    Fleet(const Fleet&) = delete;
    Fleet& operator=(const Fleet&) = delete;

    /// No broker of the list accepts these connections; in words. Set it before the first join.
    std::function<void(const std::string& why)> on_hopeless;

    /// Does it to `count` boards: those that have been in their present condition for longest. Fewer where
    /// there are not so many.
    void perform(const Plan::Due& due);
    /// All present boards say goodbye, and `done` is called when all is sent, or `limit` is over.
    void end(Duration limit, std::function<void()> done);

    /// Boards of all conditions.
    std::size_t size() const { return slots_.size(); }
    /// Boards whose agents run and are connected, or try to be.
    std::size_t present() const { return present_.size(); }
    /// Present, and the broker has its description.
    std::size_t announced() const { return announced_; }
    /// No board is away for a while, and each that is present is announced.
    bool settled() const {
        return announced_ == present_.size() && present_.size() + absent_.size() == slots_.size();
    }
    /// Goes through all connections: not for each message.
    Tally tally() const;

    /// The prefix of the options, and the number: `load-7`.
    std::string name(std::size_t board) const;
    /// The number of a board of this name; nothing where it is none of ours.
    std::optional<std::size_t> number(std::string_view name) const;
    /// What a registry should say of it now: "online", "lost", "offline"; empty: it never was there, or is
    /// between two states.
    std::string_view expected(std::size_t board) const;
    /// When that began.
    Time since(std::size_t board) const { return slots_[board].said.value_or(slots_[board].began); }

  private:
    // kNever: not joined yet. kAway: the connection broke and comes back. kHung: connected, and silent.
    // kDead: the connection broke for good. kLeft: it said goodbye.
    enum class Life : std::uint8_t { kNever, kPresent, kAway, kHung, kDead, kLeft };
    struct Slot {
        std::unique_ptr<SimulatedBoard> board;
        Time began{};              // this life
        std::optional<Time> said;  // its first description of this life
        Time armed = Time::max();
        Life life = Life::kNever;
        bool acknowledged = false;  // the broker has the description of this life
    };
    /// A connection: of every board whose number leaves its own when divided by how many there are.
    struct Carrier {
        std::unique_ptr<mqtt::Client> client;
        bool connected = false;
    };
    /// When a board wants to be called. Of several entries for one board the one that is equal to Slot::armed
    /// counts.
    struct Deadline {
        Time at;
        std::uint32_t board;
        bool operator>(const Deadline& other) const { return at > other.at; }
    };

    // Life and death (fleet.cpp)
    bool own_connection() const { return options_.per_connection == 1; }
    std::size_t carrier_of(std::size_t board) const { return board % carriers_.size(); }
    std::optional<std::size_t> pick(Verb verb);
    void join(std::size_t board);
    void disconnect(std::size_t board, Life next);
    void come_back(std::size_t board);
    void hang(std::size_t board);
    void leave(std::size_t board);
    void attach(std::size_t board);
    void open(std::size_t carrier);
    template <class Call>
    void for_boards_of(std::size_t carrier, Call&& call) const {
        for (std::size_t board = carrier; board < slots_.size(); board += carriers_.size())
            call(board);
    }
    void close(Carrier& carrier);
    void stop_own_client(std::size_t board);
    void arm(std::size_t board);
    void arm_at(std::size_t board, Time at);
    void arm_timer();
    void run_due();
    void settle(std::size_t board, Life life);
    void schedule_values();

    // Messages (fleet_messages.cpp)
    template <class Call>
    void with(std::size_t board, Call&& call);
    void publish(std::size_t board, member::Announcements& out);
    void later(std::function<void()> call);
    void conflict(std::size_t board, const std::string& why);
    mqtt::Client::Handlers handlers(std::size_t carrier);
    void connected(std::size_t carrier);
    void received(std::size_t carrier, const mqtt::Message& message);
    void acknowledged(const std::string& topic);
    void report_values();

    boost::asio::io_context& io_;
    FleetOptions options_;
    const BoardKind& kind_;
    Random random_;
    bus::Topics topics_;
    std::string host_;
    std::vector<Slot> slots_;
    std::vector<Carrier> carriers_;
    std::deque<std::uint32_t> present_;  // and each of the others is in absent_, but those that are away
    std::deque<std::uint32_t> absent_;
    std::priority_queue<Deadline, std::vector<Deadline>, std::greater<>> deadlines_;
    boost::asio::steady_timer timer_;
    Time timer_at_ = Time::max();
    boost::asio::steady_timer values_timer_;
    double values_due_ = 0;
    std::size_t next_value_ = 0;
    Time values_since_{};
    std::size_t announced_ = 0;
    Tally tally_;
    bool conflict_logged_ = false;
    bool ending_ = false;
    std::size_t stopping_ = 0;  // clients that have not stopped
    boost::asio::steady_timer end_timer_;
    std::function<void()> ended_;
};

template <class Call>
void Fleet::with(std::size_t board, Call&& call) {
    Slot& slot = slots_[board];
    if (!slot.board || ending_) return;
    member::Announcements out;
    call(*slot.board, Clock::now(), out);
    publish(board, out);
    if (out.fatal)
        later([this, board, why = out.fatal->text] { conflict(board, why); });
    else
        arm(board);
}

}  // namespace asip::load
