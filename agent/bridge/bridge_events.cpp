// SPDX-License-Identifier: Apache-2.0
// What the session says of the board.
#include <utility>

#include "agent/bridge/bridge.hpp"
#include "asip/program/exit_status.hpp"

namespace asip::agent {

using program::log::Level;

namespace {

constexpr Duration kGarbageQuiet = std::chrono::seconds(10);

const char* why_unanswered(const session::NoAnswer& none, bool tcp) {
    if (none.heard_banner)
        return " said that it is an ASIP board, and answers no question: does it restart again and again "
               "(its power), is its sketch busy for seconds, or does the line lose what is sent to it?";
    if (tcp)
        return none.heard_bytes ? " sends bytes, but they are not ASIP: is it the port of another program, "
                                  "or one that frames lines otherwise (HOST:PORT/frames, HOST:PORT/lines)?"
                                : " takes the connection and does not answer: is an ASIP board behind it, "
                                  "does it serve another client already, or does it frame lines otherwise "
                                  "(HOST:PORT/frames for the bridge of the Java programs, HOST:PORT/lines)?";
    if (none.heard_bytes)
        return " sends bytes, but they are not ASIP at 57600 baud or any rate that a board steps up to: is "
               "it another device, a sketch without ASIP, or does another program read from this port, too "
               "(fuser PORT, lsof PORT; brltty, ModemManager)?";
    return " does not answer: is an ASIP sketch loaded (asip firmware: AsipHello), and is it the right port?";
}

}  // namespace

void Bridge::on_action(const session::BoardLine& line, Time now, Effects& out) {
    client_requests_.on_line(line, session().identity(), out);
    if (line.line.is_error()) statistics_.board_error(line.line.error().code);
    if (!found_) return;
    const auto decoded = context_.decode(line.line);
    if (decoded && decoded->value) {
        if (describer_.note_event(decoded->service, *decoded->value)) describe_again(now);
        values_.reported(decoded->service, *decoded->value, now);
    }
    if (!announcer_->may_publish()) return offline_values_.keep(line.line, statistics_);
    const bool warned = !context_.warning().empty();
    context_.publish(line.line, decoded, out, line.owner ? control_.sender_of(*line.owner) : std::string());
    if (!warned && !context_.warning().empty()) show_warnings(now);
}

void Bridge::on_action(const session::Identified& identified, Time now, Effects& out) {
    const auto& board = session().identity();
    if (!name().empty() && is_another_name()) return leave_for_another(now, out);
    board_.services = session::ServiceTable(board, models_);
    periods_.board_found(board_.services, now);
    describer_.board_found(identified.changed, periods_);
    if (options_.loadable_version)
        describer_.loadable_version(options_.loadable_version(board.info.sketch, board.info.chip));
    if (name().empty()) name_board(now, out);
    if (!std::exchange(found_, true) && (!options_.keep_outputs || is_stopped())) safety_.stop_services();
    out.board_known = true;
    was_away_ = false;
    out.log(restarts_.many() ? Level::kDebug : Level::kInfo,
            identified.changed ? "board identified" : "board back",
            {{"board", name()},
             {"chip", board.info.chip},
             {"sketch", board.info.sketch},
             {"services", letters()},
             {"baud", std::to_string(board_.session.baud())}});
    unreached_.clear();
    describe_again(now);
    compare_with_first(port_.phase() != PortLoan::Phase::kOurs, now, out);
    port_.identified(traits(), out);
    announcer_->set_updating(port_.updating());
    announcer_->set_state(model::BoardState::kOnline, reason_to_be_online(), now, out);
    values_.identified(now);
    learn_levels(now, out);
    ends_ = false;
    links_.target_back();
}

model::StateReason Bridge::reason_to_be_online() const {
    return is_stopped() ? model::StateReason::kLatched : model::StateReason::kNone;
}

// Another state says why the board is not there.
void Bridge::show_stop(Time now, Effects& out) {
    board_.session.hold_outputs(is_stopped());
    if (describer_.note_stop(latch_.stopped())) describe_again(now);
    if (announcer_->state() == model::BoardState::kOnline)
        announcer_->set_state(model::BoardState::kOnline, reason_to_be_online(), now, out);
}

void Bridge::name_board(Time now, Effects& out) {
    if (name().empty()) choose_name();
    auto kept = options_.load_labels ? options_.load_labels(name()) : Expected<model::Labels>();
    if (!kept) out.log(Level::kError, "labels cannot be read", {{"why", kept.error()}});
    labels_.load(std::move(kept));
    describer_.note_labels(labels_);
    if (options_.load_stop) latch_.load(options_.load_stop(name()));
    board_.session.hold_outputs(is_stopped());
    describer_.note_stop(latch_.stopped());
    if (is_stopped()) out.log(Level::kWarning, latch_.why_refused(name()));
    if (options_.load_links) links_.load(options_.load_links(name()), is_stopped(), now, out);
    announcer_ = std::make_unique<Announcer>(
        board_.topics,
        AnnouncerOptions{name(), options_.lease_seconds, options_.takeover, options_.started_unix,
                         options_.on_shared_topic, named_by_board_},
        random_);
}

// Boards say the level of an input when its mode is set, and otherwise when it changes.
void Bridge::learn_levels(Time now, Effects& out) {
    if (is_stopped() || leaving_) return;
    session::Actions actions;
    for (const auto& line : values_.lines_to_learn(labels_.current())) {
        const auto request = protocol::parse_request(line);
        const auto id = board_.session.submit(
            *request,
            {.client = ReportPeriods::kClient, .deadline = now + session::kDefaultDeadline, .prove = true},
            now, actions);
        if (id) values_.queued(*id, line);
    }
    perform(actions, now, out);
}

void Bridge::on_action(const session::BoardReset& reset, Time now, Effects& out) {
    safety_.board_restarted(out);
    values_.restarted(now);
    out.log(note_restart(now) ? Level::kWarning : Level::kDebug, "board restarted by itself",
            {{"why", reset.why}});
}

void Bridge::on_action(const session::BecameSilent&, Time now, Effects& out) {
    out.log(Level::kWarning, "board silent", {{"board", name()}});
    if (announcer_) announcer_->set_state(model::BoardState::kLost, model::StateReason::kSilent, now, out);
    was_away_ = true;
    safety_.board_gone(out);
    out.reopen_link = describer_.link().kind == "tcp";
}

void Bridge::on_action(const session::NoAnswer& none, Time now, Effects& out) {
    if (announcer_ && announcer_->state() == model::BoardState::kLost)
        announcer_->set_state(model::BoardState::kLost, model::StateReason::kSilent, now, out);
    const auto text = describer_.link().path + why_unanswered(none, describer_.link().kind == "tcp");
    // A board that was here may come back; a port where none ever was is more likely the wrong one.
    if (!found_ && !options_.announce_unreached) {
        out.fatal = Fatal{program::kExitBoard, text};
        return;
    }
    if (unreached_ != text) out.log(Level::kWarning, text + " Asking on");
    unreached_ = text;
    if (name().empty()) name_unanswered(now, out);
    announce_unreached(model::StateReason::kSilent, now, out);
    if (!found_ && options_.name.empty()) rest(now, out);
}

void Bridge::on_action(const session::LineRateChanged& change, Time, Effects& out) {
    describer_.line_rate_changed(change.baud);
    out.log(Level::kInfo, "line rate", {{"baud", std::to_string(change.baud)}, {"why", change.why}});
}

void Bridge::on_action(const session::Garbage& garbage, Time now, Effects& out) {
    client_requests_.on_garbage(out);
    if (garbage_quiet_until_ && now < *garbage_quiet_until_) return;
    garbage_quiet_until_ = now + kGarbageQuiet;
    out.log(Level::kWarning, "garbage from the board",
            {{"reason", garbage.reason},
             {"sample", garbage.sample},
             {"count", std::to_string(session().counters().garbage)}});
}

void Bridge::on_action(const session::LevelRestored& restored, Time now, Effects&) {
    values_.executed(restored.line, now);
}

void Bridge::on_action(const session::Finished& end, Time now, Effects& out) {
    const auto request = values_.on_finished(end, now);
    if (request && links_.any()) links_.executed(values_.set_by(*request), control_.link_of(end.id));
    tell_modes(now);
    safety_.on_finished(end, now, out);
    periods_.on_finished(end, now, out);
    control_.on_finished(end, now, out);
    client_requests_.on_finished(end, session().identity(), out);
    if (describer_.note_settings(periods_)) describe_again(now);
}

void Bridge::describe_again(Time now) {
    if (!announcer_) return;
    auto description = describer_.description();
    values_.describe(description, now);
    announcer_->describe(std::move(description));
}

// A pin is what commands made it: that is kept, and stands in the description.
void Bridge::tell_modes(Time now) {
    const auto modes = values_.take_modes();
    if (modes.empty()) return;
    labels_.note_modes(modes, now);
    if (describer_.note_labels(labels_)) describe_again(now);
    values_.modes_told(modes, now);
}

}  // namespace asip::agent
