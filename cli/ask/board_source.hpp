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

/// Registries answer sooner; only after it is asked whether there is one at all.
inline constexpr std::chrono::milliseconds kAnswerPatience{30};
/// Agents answer a probe within a second.
inline constexpr std::chrono::milliseconds kProbeWindow{1200};

/// A board and all that is known of it.
struct KnownBoard {
    bus::BoardItem item;
    std::optional<model::Description> description;  ///< none: it takes part by its names only
    std::string description_fault{};                ///< or this is wrong with it

    /// For a person, about a board without one: `publishes no description`, or what is wrong with it.
    std::string why_no_description() const;
    std::vector<std::string> service_names() const;
};

/// That `name`, a name or a pattern, is none of `all` boards: with the nearest, and what to do.
Failure no_such_board(const std::string& name, const std::vector<std::string>& all);

/// Finds boards: asks a registry, and where none is, reads the service bus itself (and reports that once on
/// standard error).
class BoardSource {
  public:
    /// Make it before session.connect(): then finding a registry costs no round trip of its own.
    BoardSource(const Environment& environment, BusSession& session);
    ~BoardSource() { session_.on_board({}); }
    BoardSource(const BoardSource&) = delete;
    BoardSource& operator=(const BoardSource&) = delete;

    /// All that `query` asks for, every page, in the order of their names.
    Outcome<std::vector<bus::BoardItem>> boards(bus::Query query);
    /// The same with their descriptions.
    Outcome<std::vector<KnownBoard>> known_boards(bus::Query query);
    Outcome<std::vector<bus::ServiceItem>> services(bus::Query query);
    /// The same boards as `boards`, as far as a table needs them: in a small part of the time where they are
    /// many.
    Outcome<bus::BriefRows> brief_boards(bus::Query query);

    /// Changes that a registry has kept, the newest first, at most `count`, none older than `since`. Fails
    /// with kExitFailure where none keeps a history, and with kExitNoAnswer where there is no registry.
    Outcome<std::vector<bus::HistoryItem>> history(bus::Query query, std::size_t count,
                                                   text::WallTime since = {});

    /// One board by the quickest way: what is retained, else a registry, else a probe. Fails with
    /// kExitNoAnswer and the nearest name.
    Outcome<KnownBoard> board(const std::string& name);
    /// The same, as far as the broker has it retained: at once, or not at all.
    std::optional<KnownBoard> retained_board(const std::string& name);
    /// The same, with what only a registry knows (when it was seen) where there is one.
    Outcome<KnownBoard> board_in_full(const std::string& name);

    /// Names of boards, as fast as they can be had: for suggestions and completion. Never fails.
    std::vector<std::string> names();

    /// Id of a registry that answers a query now; empty, with a note on standard error, when none does.
    std::string find_registry();
    /// Id of the registry that answered last; empty: none did.
    const std::string& registry() const { return registry_; }
    /// What was read from the bus itself; `read_bus` reads it, with a window for answers to a probe or
    /// without.
    catalogue::BusView& bus() const { return session_.boards(); }
    void read_bus(bool probe);
    /// Called for each description that is published while we look (not for those retained).
    void on_announcement(std::function<void(const std::string& board, const std::string& session)> handler);

  private:
    Outcome<bus::Answer> ask(const bus::Query& query);
    Outcome<bus::Answer> ask_all_pages(bus::Query query);
    /// Whether more pages are said to follow a `page`, asked for by `cursor`, behind which none can.
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

}  // namespace asip::cli
