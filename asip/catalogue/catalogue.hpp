// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <functional>
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

/// A message of the service or context bus, its topic parsed. The views live as long as the call.
struct Announcement {
    bus::TopicKind kind = bus::TopicKind::kProbe;
    std::string_view board;
    std::string_view payload;
    bool retained = false;  ///< stored before we subscribed: a hint of what was, no sign of life
    std::optional<std::uint32_t> expiry_seconds;  ///< what is left of it, as the broker reports
    bool ages_are_of_now = false;  ///< written by another catalogue just now, not by an agent when it
                                   ///< announced
};

/// Why a message changed nothing. Counted; the first of a board is worth a log line.
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

/// Counts since the catalogue was made, except for the numbers that describe it now.
struct CatalogueStats {
    std::array<std::size_t, kStates> boards{};    ///< now, by effective state
    std::array<std::size_t, kStates> services{};  ///< now, by effective state of their board
    std::size_t conflicts = 0;                    ///< now
    std::uint64_t applied = 0;                    ///< messages given to apply()
    std::uint64_t renewals = 0;                   ///< of these, descriptions that changed nothing but `seq`
    std::uint64_t expired = 0;                    ///< leases that ran out
    std::array<std::uint64_t, kRefusals> refused{};
};

/// The two clocks at one instant, for turning the times of the catalogue into times of day.
struct Instant {
    Time time;
    text::WallTime wall;
};

/// What an asker may see: boards, and services of these. An empty function lets everything be seen. What is
/// not seen is as if it were not there: no answer, number or cursor says anything of it.
struct View {
    std::function<bool(std::string_view board)> board{};
    std::function<bool(std::string_view board, std::string_view service)> service{};
};

/// A name as micro-controllers publish it: they end what they publish as they end lines.
std::string_view without_line_end(std::string_view text);

/// The live catalogue of boards and services: a function of the messages seen and the time. No socket, clock
/// or thread inside.
///
/// What is the same, whatever the order: two catalogues that were given the same messages, interleaved,
/// duplicated and replayed in any way, hold the same boards with the same session, sequence number,
/// description and services, provided that for each board
///  - the live `$state` messages came in their order (MQTT keeps the order of one publisher on one topic),
///  and
///  - where sessions do not begin with the time of their start, a session's first message came after the
///  first message of the session that it replaced.
/// Messages of a session in any order end at its highest `seq`; those of a replaced session, seen before,
/// change nothing; of two sessions that both live, both catalogues end with the larger one as holder (agents'
/// sessions begin with the time of their start: the later one; an earlier one, of an agent whose clock went
/// back, counts by what it says after the lease of the later one). Times
/// (last seen, lease) are those of the newest message that counted, so a duplicate may extend a lease by at
/// most its length.
///
/// The state of a board is said by its agent: in its descriptions, where they hold one, else on `$state`. Of
/// an agent whose descriptions hold the state `$state` counts only as what the broker says in its place:
/// "lost" (or "offline") after the last description. Only a description with a higher number, or a newer
/// session, makes such a board be there again. A lease that ran out makes it lost until its agent is heard.
/// Neither a renewal nor a name nor traffic changes what was said.
///
/// Retained messages are hints: they describe what a board is, but only a lease makes it alive. A retained
/// description opens a lease of what is left of it according to the broker, or, where the broker does not
/// report that, a whole one: it may have been announced just now. The same one again opens none.
///
/// Names are checked (invalid ones are refused), texts bounded, memory bounded by `max_boards`. Not copyable.
class Catalogue {
  public:
    /// What is known of a board from before this catalogue was made.
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
        /// Asked when a board is added, shown or to be forgotten: where it is known, its times continue.
        std::function<std::optional<Remembered>(std::string_view board)> remembered = {};
        /// random in programs, so that strangers cannot choose names that collide
        std::uint64_t hash_seed = 1;
    };

    Catalogue();
    explicit Catalogue(Options options);
    ~Catalogue();

    /// `now` is not earlier than in any call before. Judging leases is expire()'s: call it first where that
    /// matters.
    Applied apply(const Announcement& announcement, Time now);

    /// Leases that ran out and boards to be forgotten at `now`. Nothing while suspended.
    std::vector<Event> expire(Time now);
    /// When to call expire() next; not later than anything happens. Empty: nothing will.
    std::optional<Time> next_expiry() const;

    /// The bus cannot be heard: leases are not judged until resume().
    void suspend();
    /// The bus is heard again and its retained messages will be replayed: what was alive has `grace` to
    /// report so.
    void resume(Time now);
    bool suspended() const;

    /// Why a board cannot be forgotten, or the events of it.
    enum class NotForgotten { kUnknown, kAlive };
    Expected<std::vector<Event>, NotForgotten> forget(std::string_view board, Time now);

    /// Boards or services, one page. Fails with a sentence on a cursor or a sort order that is none.
    /// Find::kHistory is not the catalogue's. The answer's seq is set; id, registry and epoch are left to the
    /// caller.
    /// `view`: whose answer it is; null: of a user who sees everything. Of a BoardItem its services are
    /// left to the caller.
    Expected<bus::Answer> find(const bus::Query& query, Instant now, const View* view = nullptr);
    /// `full`: with its whole description.
    std::optional<bus::BoardItem> board(std::string_view name, Instant now, bool full = false) const;
    /// The names behind `after`, in their order, at most `max` of them. `pattern` only says where to begin
    /// and end: names that do not match it may be among them. So what is looked at in one call is bounded.
    std::vector<std::string> names(const std::string& pattern, const std::string& after, std::size_t max);
    /// Names of boards that match a pattern and are not alive.
    std::vector<std::string> forgettable(std::string_view pattern) const;

    /// Number of the last change.
    std::uint64_t seq() const;
    std::size_t size() const;
    bool knows(std::string_view board) const;
    /// Each board with its effective state, in no order.
    void for_each(const std::function<void(std::string_view board, model::BoardState, model::StateReason)>&
                      visit) const;
    CatalogueStats stats() const;
    /// Of a message whose topic is not one of the bus: it is counted with those that apply() refused.
    void count_refused(Refusal refusal);
    /// Services now, by kind.
    std::vector<std::pair<std::string, std::size_t>> services_by_kind() const;
    /// The same of what a user sees, and boards by state. Where something is hidden it looks at every
    /// board.
    std::vector<std::pair<std::string, std::size_t>> services_by_kind(const View& view) const;
    std::array<std::size_t, kStates> boards_by_state(const View& view) const;

    /// Puts what changed in its place in the indices; find() does it, too. Call it now and then when nothing
    /// asks.
    void settle();

    class Impl;

  private:
    friend struct CatalogueCheck;  // tests compare what it holds
    std::unique_ptr<Impl> impl_;
};

}  // namespace asip::catalogue
