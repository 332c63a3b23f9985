// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "agent/bridge/board.hpp"
#include "agent/bridge/effects.hpp"
#include "agent/clients/client_requests.hpp"
#include "agent/command/control.hpp"
#include "agent/counts/restarts.hpp"
#include "agent/counts/statistics.hpp"
#include "agent/describe/describer.hpp"
#include "agent/describe/label_book.hpp"
#include "agent/inbound/command_age.hpp"
#include "agent/inbound/inbound.hpp"
#include "agent/links/link_book.hpp"
#include "agent/port/port_loan.hpp"
#include "agent/reports/board_values.hpp"
#include "agent/reports/context.hpp"
#include "agent/reports/offline_values.hpp"
#include "agent/reports/report_periods.hpp"
#include "agent/safety/safety.hpp"
#include "agent/safety/stop_latch.hpp"
#include "asip/member/announcer.hpp"
#include "asip/model/model_set.hpp"
#include "asip/session/board_session.hpp"
#include "asip/session/service_table.hpp"

namespace asip::agent {

using member::Announcer;
using member::AnnouncerOptions;

/// How the board is called, announced and served. Defaults suit real boards.
struct BridgeOptions {
    std::string topic_root = "asip";
    std::string name;  ///< empty: the one stored on the board, else from the link
    int lease_seconds = model::kDefaultLeaseSeconds;
    bool takeover = false;
    bool lent = false;  ///< by a browser: its name begins with link::kLentPrefix
    std::uint64_t started_unix = 0;
    bool on_shared_topic = true;  ///< see AnnouncerOptions
    bool keep_outputs = false;    ///< do not stop the board's services when it is found first
    /// A named board that cannot be reached at the start is announced as lost, with the reason; so is a port
    /// where something speaks no ASIP.
    bool announce_unreached = false;
    model::Labels labels;  ///< of the configuration: they cannot be changed over the bus
    /// The labels that were kept; empty ones where none were.
    std::function<Expected<model::Labels>(const std::string& board)> load_labels;
    /// The stop that was kept and still holds, if any.
    std::function<Expected<std::optional<model::StopInfo>>(const std::string& board)> load_stop;
    std::function<LinkFiles::Loaded(const std::string& board)> load_links;
    /// The version of this sketch that may be loaded into such a chip; 0: none.
    std::function<int(const std::string& sketch, const std::string& chip)> loadable_version;
    std::string bus_user;                ///< of the broker, may be empty
    std::function<int()> second_of_day;  ///< by the clock on the wall; empty: of this machine
    session::SessionOptions session;
    /// With `context.client_side`, `/in` and `/out` are named as the client sees them: lines of the board go
    /// to `/in`, and only requests there that want an answer are executed.
    ContextOptions context;
    ReportOptions reports;
};

/// Everything between a board's bytes and the bus's messages: session, announcer, and the rooms for commands,
/// safety, reports, description, port and clients. Pure.
/// The order of a life: link_up() and receive() until Effects::board_known. Then name() is valid, and the
/// caller connects to the broker with will() and subscriptions(). From Effects::name_claimed on it subscribes
/// to control_subscriptions(), too, and listens for stops over a StopLine. bus_subscribed() then says that
/// all commands arrive. Times do not go back.
class Bridge {
  public:
    Bridge(BridgeOptions options, model::ModelSet models, Random random);

    // --- the board's side
    void link_up(session::LinkTraits traits, model::LinkInfo link, Time now, Effects& out);
    void link_down(const std::string& why, Time now, Effects& out);
    void receive(std::string_view bytes, Time now, Effects& out);
    /// The link cannot be opened: the description gives `reason` until it is.
    void unreached(model::StateReason reason, const std::string& why, model::LinkInfo link, Time now,
                   Effects& out);
    const std::string& why_unreached() const { return unreached_; }
    /// As BoardSession::not_watched().
    void not_watched(Time since, Time now);
    /// The answer to session::SetLineRate.
    void line_rate_set(bool ok, Time now, Effects& out);

    /// False for a stop that the broker stored, and for one sent before the board was resumed.
    bool obeys(const Stop& stop) const;
    bool is_stopped() const { return latch_.stopped().has_value(); }

    // --- firmware that is loaded: see Effects::load
    void loading(std::string_view step, int percent);
    void loaded(const Expected<void>& result, Time now, Effects& out);

    // --- the bus's side
    /// `expires`: what this broker retains.
    void bus_connected(Time now, const std::string& client_id, bool expires, Effects& out);
    /// Every subscription that brings commands is granted.
    void bus_subscribed(Time now, Effects& out);
    void bus_disconnected();
    /// To be called once the board is known, where the broker knows its users.
    void leave_shared_topic() { announcer_->leave_shared_topic(); }
    /// A message of the bus; nothing where it is not for this agent. It may wait before take(), see
    /// takes_turns().
    std::optional<Inbound> read(const mqtt::Message& message, Time now) const;
    void take(const Inbound& message, Time now, Effects& out);
    /// Ends the requests that waited at Effects::stopped: apart, since thousands must not delay the stop's
    /// first byte.
    void refuse_waiting(Time now, Effects& out);
    CommandAge& age() { return age_; }

    enum class ClientResult {
        kAccepted,
        kRefused,  ///< an error line for that client is among the effects
        kLater,    ///< too many lines of this client wait for the board; to be given again
    };
    /// `client`: any number below kBusClient; lines of one client keep their order. `sent`: the earliest
    /// time, where that is long ago.
    ClientResult client_line(session::ClientId client, std::string_view line, std::optional<Time> sent,
                             Time now, Effects& out);
    /// Enough lines to keep a board busy, few enough that a slow one executes the last in time.
    static constexpr std::size_t kMaxClientLines = 16;
    /// So long a port where nothing has ever answered is left free between two tries.
    static constexpr Duration kRest = std::chrono::seconds(30);

    bool name_claimed() const { return name_claimed_; }
    bool may_publish() const { return announcer_ && announcer_->may_publish(); }
    /// To be called periodically.
    void publish_statistics(const mqtt::Counters& bus, Time now, Effects& out);

    /// What became of Effects::keep_labels.
    void labels_kept(const Expected<std::filesystem::path>& result, Time now, Effects& out);

    // --- links (bridge_links.cpp)
    /// What became of Effects::keep_links.
    void link_kept(std::uint64_t ticket, const Expected<void>& result, Time now, Effects& out);
    /// What their sources publish comes over a connection of its own: no source delays a command.
    std::set<std::string> source_subscriptions() const { return links_.filters(); }
    /// Rises when these may be others.
    std::uint64_t source_changes() const { return links_.filter_changes(); }
    void sources_heard(bool heard, Time now);
    void source_message(const mqtt::Message& message, Time now, Effects& out);
    /// How this board stands, for links of this process.
    struct Standing {
        const std::vector<property::Property>& properties;
        property::ValueDocument values;
        bool present = false;
    };
    Standing standing(Time now) const;
    /// Rises with each change of standing().
    std::uint64_t standing_changes() const;
    bool has_source(std::string_view board) const { return links_.has_source(board); }
    void source_stands(const Standing& source, Time now, Effects& out);
    void source_gone(const std::string& board, Time now, Effects& out);

    /// Call it behind each of the others, before their effects are performed: making the document takes a
    /// while.
    void publish_values(Time now, Effects& out);

    /// Must be called when next_deadline() has come; may be called at any time.
    void tick(Time now, Effects& out);
    std::optional<Time> next_deadline() const;
    /// Undoes all commands with a hold, before the goodbye. True: the board has not confirmed that yet.
    bool release_holds(Time now, Effects& out);
    /// The board has confirmed all that makes it safe.
    bool is_safe() const { return !safety_.pending(); }
    /// Sets the line rate at which the next program expects the board; before the goodbye.
    void leave_line(Time now, Effects& out);
    bool has_left_line() const { return session().state() == session::BoardSession::State::kDown; }
    /// Ends every open command and publishes `offline`: the last call.
    void goodbye(Time now, Effects& out);

    /// Empty until the board was identified.
    const std::string& name() const { return board_.name; }
    mqtt::Message will() const { return announcer_->will(); }
    std::vector<member::Announcer::Subscription> subscriptions() const;
    /// To be added once the name is claimed: until then another agent is meant.
    std::vector<member::Announcer::Subscription> control_subscriptions() const;
    const session::BoardSession& session() const { return board_.session; }

  private:
    void on_message(const Command& command, Time now, Effects& out);
    void on_message(const Renewal& renewal, Time now, Effects& out);
    void on_message(const Stop& stop, Time now, Effects& out);
    void on_message(const Resume& resume, Time now, Effects& out);
    void on_message(const PortRequest& request, Time now, Effects& out);
    void on_message(const LabelRequest& request, Time now, Effects& out);
    void on_message(const LinkRequest& request, Time now, Effects& out);
    void on_message(const DemandMessage& demand, Time now, Effects& out);
    void on_message(const Leftover& left, Time now, Effects& out);
    void on_message(const Announcement& announcement, Time now, Effects& out);
    void name_board(Time now, Effects& out);
    void announce_unreached(model::StateReason reason, Time now, Effects& out);
    void name_unanswered(Time now, Effects& out);
    void tick_port(Time now, Effects& out);
    void let_go_of_port(Time now, Effects& out);
    void rest(Time now, Effects& out);
    void withdraw(Effects& out) const;
    BoardTraits traits() const;
    void perform(session::Actions& actions, Time now, Effects& out);
    void send_safe_lines(Time now, Effects& out);
    void send_periods(Time now, Effects& out);
    void run_links(Time now, Effects& out);
    void tell_modes(Time now);
    void learn_levels(Time now, Effects& out);
    void on_action(const session::BoardLine& line, Time now, Effects& out);
    void on_action(const session::LevelRestored& restored, Time now, Effects& out);
    void on_action(const session::Identified& identified, Time now, Effects& out);
    void on_action(const session::BoardReset& reset, Time now, Effects& out);
    void on_action(const session::BecameSilent& silent, Time now, Effects& out);
    void on_action(const session::NoAnswer& none, Time now, Effects& out);
    void on_action(const session::LineRateChanged& change, Time now, Effects& out);
    void on_action(const session::Garbage& garbage, Time now, Effects& out);
    void on_action(const session::Finished& end, Time now, Effects& out);
    std::string letters() const;
    /// The one stored on the board, as it is called on the bus; empty: none is stored.
    std::string stored_name() const;
    std::string name_of_port() const;
    void choose_name();
    bool is_another_name() const;
    void leave_for_another(Time now, Effects& out);
    void yield_name(Effects& out);
    void compare_with_first(bool flashed, Time now, Effects& out);
    void show_warnings(Time now);
    void show_stop(Time now, Effects& out);
    model::StateReason reason_to_be_online() const;
    bool note_restart(Time now);
    void tick_restarts(Time now, Effects& out);
    void describe_again(Time now);
    void start_publishing(Effects& out);

    BridgeOptions options_;
    model::ModelSet models_;
    Random random_;
    Board board_;
    Statistics statistics_;
    CommandAge age_;
    BoardValues values_;
    Safety safety_;
    ReportPeriods periods_;
    StopLatch latch_;
    std::optional<Resume> resumed_;  // the last one that was obeyed and told when it was sent
    Control control_;
    ClientRequests client_requests_;
    Context context_;
    PortLoan port_;
    LabelBook labels_;
    Describer describer_;
    LinkBook links_;
    std::unique_ptr<Announcer> announcer_;  // once there is a name
    bool found_ = false;                    // the board, at least once
    std::string unreached_;                 // why the link cannot be opened
    bool named_by_board_ = false;           // the name is stored on the board
    bool name_claimed_ = false;
    bool was_away_ = false;  // the board, since it was identified
    bool ends_ = false;      // the board was made safe: nothing moves it until it is found again
    bool leaving_ = false;   // for another name: nothing more is sent to the board
    struct FirstBoard {
        BoardTraits traits;
        std::string services;
        bool operator==(const FirstBoard&) const = default;
    };
    std::optional<FirstBoard> first_board_;
    std::string other_board_;  // the warning that it is another one now
    Restarts restarts_;
    OfflineValues offline_values_;
    std::optional<Time> garbage_quiet_until_;
    std::optional<Time> rests_until_;  // at whose port nothing answers: it is free meanwhile
};

}  // namespace asip::agent
