// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "asip/bus/registry/answer.hpp"
#include "asip/bus/registry/items.hpp"
#include "asip/bus/registry/query.hpp"
#include "asip/catalogue/bus_view.hpp"
#include "asip/model/description.hpp"
#include "cli/ask/bus_session.hpp"

namespace asip::cli {

/// Registries answer sooner; then it is asked whether there is one.
inline constexpr std::chrono::milliseconds kAnswerPatience{30};
/// Agents answer a probe within a second.
inline constexpr std::chrono::milliseconds kProbeWindow{1200};

struct KnownBoard {
    bus::BoardItem item;
    std::optional<model::Description> description;  ///< none: it takes part by its names only
    std::string description_fault{};                ///< or this is wrong with it

    /// For a person, about a board without one: `publishes no description`, or what is wrong with it.
    std::string why_no_description() const;
    std::vector<std::string> service_names() const;
};

/// With the nearest of `all`, and what to do. `name` may be a pattern.
Failure no_such_board(const std::string& name, const std::vector<std::string>& all);

/// Finds boards: asks a registry; where none is, reads the bus itself, and reports that once.
class BoardSource {
  public:
    /// Before session.connect(), so that finding a registry costs no round trip.
    BoardSource(const Environment& environment, BusSession& session);
    ~BoardSource() { session_.on_board({}); }
    BoardSource(const BoardSource&) = delete;
    BoardSource& operator=(const BoardSource&) = delete;

    /// Every page, by name.
    Outcome<std::vector<bus::BoardItem>> boards(bus::Query query);
    Outcome<std::vector<KnownBoard>> known_boards(bus::Query query);
    Outcome<std::vector<bus::ServiceItem>> services(bus::Query query);
    /// As far as a table needs them: much quicker for many boards.
    Outcome<bus::BriefRows> brief_boards(bus::Query query);

    /// From a registry, the newest first, at most `count`, none older than `since`. Fails with kExitFailure
    /// without a history, with kExitNoAnswer without a registry.
    Outcome<std::vector<bus::HistoryItem>> history(bus::Query query, std::size_t count,
                                                   text::WallTime since = {});

    /// Values that a registry has kept, or the properties of which it has some. Fails as history() does.
    Outcome<bus::Answer> values(bus::Query query);

    /// The quickest way: what is retained, else a registry, else a probe. Fails with kExitNoAnswer and the
    /// nearest name.
    Outcome<KnownBoard> board(const std::string& name);
    /// As far as the broker retains it, at once.
    std::optional<KnownBoard> retained_board(const std::string& name);
    /// With what only a registry knows (when it was seen), where there is one.
    Outcome<KnownBoard> board_in_full(const std::string& name);

    /// As fast as possible, for suggestions and completion. Never fails.
    std::vector<std::string> names();

    /// That answers now; empty: none does. The user is told that, where `tell`.
    std::string find_registry(bool tell = true);
    /// The registry that answered last; may be empty.
    const std::string& registry() const { return registry_; }
    /// `read_bus` fills it, with a window for answers to a probe or without.
    catalogue::BusView& bus() const { return session_.boards(); }
    void read_bus(bool probe);
    /// For each description that is published while we look.
    void on_announcement(std::function<void(const std::string& board, const std::string& session)> handler);

  private:
    Outcome<bus::Answer> ask(const bus::Query& query);
    Outcome<bus::Answer> ask_all_pages(bus::Query query);
    /// More pages are said to follow behind `cursor`, where none can.
    bool goes_on_for_ever(const bus::Answer& page, const std::string& cursor, bool empty) const;
    tl::unexpected<Failure> without_end() const;
    bool asks_registry() const { return !environment_.from_bus && !no_registry_; }
    void without_registry(const std::string& why);
    Outcome<KnownBoard> unknown(const std::string& name);
    KnownBoard known(bus::BoardItem item) const;

    const Environment& environment_;
    BusSession& session_;
    std::vector<std::string> online_registries_;  // by their retained state
    std::string registry_;
    std::size_t answered_bytes_ = 0;  // of the pages of one answer
    bool no_registry_ = false;
    bool bus_read_ = false;
    BusSession::Subscription registries_;
};

/// What a command has that asks boards and registries.
class OnTheBus {
  protected:
    explicit OnTheBus(Environment& environment)
        : environment_(environment), session_(environment), source_(environment, session_) {}
    /// The exit status where it fails; the reason is then told.
    std::optional<int> connect() {
        const auto connected = session_.connect();
        return connected ? std::nullopt : std::optional(environment_.fail_with(connected.error()));
    }

    Environment& environment_;
    BusSession session_;
    BoardSource source_;
};

}  // namespace asip::cli
