// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "asip/bus/registry/answer.hpp"
#include "asip/bus/registry/items.hpp"
#include "asip/bus/registry/query.hpp"
#include "asip/bus/topics.hpp"
#include "asip/catalogue/description_parts.hpp"
#include "asip/expected.hpp"
#include "asip/model/board_state.hpp"
#include "asip/text/wall_time.hpp"
#include "asip/time.hpp"

namespace asip::catalogue {

/// A message with its topic parsed. The views live as long as the call.
struct Announcement {
    bus::TopicKind kind = bus::TopicKind::kProbe;
    std::string_view board;
    std::string_view payload;
    bool retained = false;  ///< stored before we subscribed: a hint of what was, no sign of life
    std::optional<std::uint32_t> expiry_seconds;  ///< what is left of it, as the broker reports
};

/// Why a message changed nothing. Counted; the first of a board deserves a log line.
enum class Refusal {
    kNotForUs,     ///< a topic the catalogue has no use for
    kBadName,      ///< board or service name that is not allowed
    kBadState,     ///< none of the words of `$state`
    kTooLong,      ///< payload beyond model::kMaxDescriptionBytes
    kMalformed,    ///< no JSON, or not what a description holds
    kWrongBoard,   ///< the description names another board than its topic
    kOldSequence,  ///< older than what is known of its session
    kOldSession,   ///< of a session that another replaced
    kUnproven,     ///< retained, while a living session contradicts it
    kConflict,     ///< of a second living session
    kOldHint,      ///< retained `$state`, while something newer was heard
    kTooMany,      ///< the catalogue is full
};
inline constexpr std::size_t kRefusals = 12;
std::string_view to_text(Refusal refusal);

struct Event {
    enum class Kind {
        // Changes; each has the next number of the sequence.
        kAdded,
        kState,
        kDescription,
        kConflict,
        kResolved,
        kForgotten,
        // What the shell should do; without number.
        kGhost,     ///< its lease ran out and its `$description` may be retained for ever: empty it
        kListen,    ///< takes part by names only: subscribe to its context traffic, which renews its lease
        kUnlisten,  ///< no longer
    };
    Kind kind;
    std::string board;
    std::uint64_t seq = 0;                                  ///< of changes
    model::BoardState state = model::BoardState::kLost;     ///< effective, after it
    model::BoardState was = model::BoardState::kLost;       ///< kState: before it
    model::StateReason reason = model::StateReason::kNone;  ///< of `state`

    bool is_change() const { return kind < Kind::kGhost; }
};

struct Applied {
    std::vector<Event> events;
    std::optional<Refusal> refused;
};

/// Counted since the catalogue was made.
struct CatalogueStats {
    std::array<std::size_t, kStates> boards{};    ///< now, by effective state
    std::array<std::size_t, kStates> services{};  ///< now, by effective state of their board
    std::size_t conflicts = 0;                    ///< now
    std::uint64_t applied = 0;                    ///< messages given to apply()
    std::uint64_t renewals = 0;                   ///< of these, descriptions that changed nothing but `seq`
    std::uint64_t expired = 0;                    ///< leases that ran out
    std::array<std::uint64_t, kRefusals> refused{};
};

/// Both clocks at one instant: they turn times of the catalogue into times of day.
struct Instant {
    Time time;
    text::WallTime wall;
};

/// What an asker may see; an empty function shows everything. No answer, number or cursor reveals what is
/// hidden.
struct View {
    std::function<bool(std::string_view board)> board{};
    std::function<bool(std::string_view board, std::string_view service)> service{};
};

/// Micro-controllers end names as they end lines.
std::string_view without_line_end(std::string_view text);

/// The live catalogue of boards and services: a function of the messages seen and the time.
/// Two catalogues that were given the same messages, interleaved, duplicated and replayed in any way, hold
/// the same boards with the same session, sequence number, description and services, if for each board
/// - the live `$state` messages came in their order (MQTT keeps the order of one publisher on one topic), and
/// - where sessions do not begin with their starting time, a session's first message came after the first one
/// of the session that it replaced.
/// A session ends at its highest `seq`, and messages of a replaced session change nothing. Of two sessions
/// that both live the larger one holds the board: agents' sessions begin with their starting time, so the
/// later one; an earlier one, of an agent whose clock went back, counts by what it says after that lease.
/// Times are those of the newest message that counted, so a duplicate extends a lease by its length at most.
/// The agent says the state of a board: in its descriptions, where they hold one, else on `$state`. Beside
/// such descriptions `$state` is only the broker's word: "lost" (or "offline") after the last one, until a
/// description with a higher number or a newer session comes. A lease that ran out makes a board lost until
/// its agent is heard. Renewals, names and traffic change no state.
/// Retained messages describe what a board is; only a lease makes it alive. A retained description opens what
/// the broker says is left of its lease; where the broker does not say, a whole one, once.
/// Names are checked, texts bounded, memory bounded by `max_boards`. Not copyable.
class Catalogue {
  public:
    /// What was known of a board before this catalogue was made.
    struct Remembered {
        std::optional<text::WallTime> first_seen;  ///< nothing: this catalogue knows it
        model::BoardState state = model::BoardState::kLost;
        std::optional<text::WallTime> since;  ///< when it came into `state`; nothing: as above
        Duration age{};  ///< for how long it has been in `state`, at the least, whatever the clocks said
    };

    struct Options {
        Duration forget_after = std::chrono::hours(7 * 24);
        Duration default_lease = std::chrono::seconds(60);
        Duration grace = std::chrono::seconds(10);
        std::size_t max_boards = 1'000'000;
        UnitsOf units_of = {};  ///< units that the fields of a standard model ("distance@1") have
        /// Asked when a board is added, shown or to be forgotten: its times continue.
        std::function<std::optional<Remembered>(std::string_view board)> remembered = {};
        /// random in programs, so that strangers cannot choose names that collide
        std::uint64_t hash_seed = 1;
    };

    Catalogue();
    explicit Catalogue(Options options);
    ~Catalogue();

    /// `now` never decreases. Where leases matter, call expire() first.
    Applied apply(const Announcement& announcement, Time now);

    /// For expire(), in programs with others to serve.
    static constexpr std::size_t kJudgedAtOnce = 10'000;
    /// Leases that ran out, and boards to be forgotten. Nothing while suspended. It judges `most` boards; the
    /// next call goes on.
    std::vector<Event> expire(Time now, std::size_t most = std::numeric_limits<std::size_t>::max());
    /// When to call expire() at the latest; empty: nothing will happen.
    std::optional<Time> next_expiry() const;

    /// The bus cannot be heard: no lease is judged until resume().
    void suspend();
    /// Retained messages will be replayed: what was alive has `grace` to report.
    void resume(Time now);
    bool suspended() const;

    enum class NotForgotten { kUnknown, kAlive };
    Expected<std::vector<Event>, NotForgotten> forget(std::string_view board, Time now);

    /// One page of boards or services. Fails with a sentence on a bad cursor or sort order; Find::kHistory is
    /// not served. The caller fills id, registry and epoch. `view`: null shows everything. A BoardItem comes
    /// without services.
    Expected<bus::Answer> find(const bus::Query& query, Instant now, const View* view = nullptr);
    /// `full`: with the whole description.
    std::optional<bus::BoardItem> board(std::string_view name, Instant now, bool full = false) const;
    /// At most `max` names behind `after`, in order. `pattern` bounds where to begin and end, so names that
    /// do not match may be among them.
    std::vector<std::string> names(const std::string& pattern, const std::string& after, std::size_t max);
    /// Boards that match and are not alive.
    std::vector<std::string> forgettable(std::string_view pattern) const;

    /// Number of the last change.
    std::uint64_t seq() const;
    std::size_t size() const;
    bool knows(std::string_view board) const;
    /// In no order.
    void for_each(const std::function<void(std::string_view board, model::BoardState, model::StateReason)>&
                      visit) const;
    CatalogueStats stats() const;
    /// Counts a message whose topic is not one of the bus.
    void count_refused(Refusal refusal);
    std::vector<std::pair<std::string, std::size_t>> services_by_kind() const;
    /// What a user sees. Where something is hidden it looks at every board.
    std::vector<std::pair<std::string, std::size_t>> services_by_kind(const View& view) const;
    std::array<std::size_t, kStates> boards_by_state(const View& view) const;
    /// Boards that are there, and whose agents have a newer version of their sketch.
    std::size_t out_of_date(const View& view) const;

    /// Puts changes into the indices, as find() does. Call it now and then.
    void settle();

    class Impl;

  private:
    friend struct CatalogueCheck;  // tests compare what it holds
    std::unique_ptr<Impl> impl_;
};

}  // namespace asip::catalogue
