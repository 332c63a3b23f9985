// SPDX-License-Identifier: Apache-2.0
// Which board is at the port: its name, and what is done where it is another one than before.
#include "agent/bridge/bridge.hpp"
#include "asip/link/cable_frames.hpp"
#include "asip/model/names.hpp"
#include "asip/program/exit_status.hpp"

namespace asip::agent {

using program::log::Level;

namespace {

std::string in_words(const BoardTraits& board, const std::string& services) {
    std::string text = board.chip + " with " + board.sketch;
    if (!services.empty()) text += " and services " + services;
    if (!board.stored_name.empty()) text += ", which calls itself " + board.stored_name;
    return text;
}

}  // namespace

std::string Bridge::letters() const {
    std::string text;
    for (const auto& entry : board_.services.entries())
        text += (text.empty() ? "" : ",") + entry.name;
    return text;
}

std::string Bridge::stored_name() const {
    const auto& stored = session().identity().stored_name;
    if (stored.empty() || !options_.lent) return stored;
    // A pupil's place is no name that a board may bring along.
    const bool pupils = stored.starts_with(link::kPupilPlace);
    return model::suggest_name(std::string(link::kLentPrefix).append(pupils ? "0-" : "").append(stored));
}

std::string Bridge::name_of_port() const {
    const auto name = describer_.name_from_link();
    return options_.lent ? model::suggest_name(std::string(link::kLentPrefix) + name) : name;
}

void Bridge::choose_name() {
    const auto stored = stored_name();
    named_by_board_ = options_.name.empty() && !stored.empty();
    board_.name = !options_.name.empty() ? options_.name : named_by_board_ ? stored : name_of_port();
}

bool Bridge::is_another_name() const {
    if (!options_.name.empty()) return false;
    const auto stored = stored_name();
    return named_by_board_ ? stored != name() : !stored.empty();
}

// Whatever is said of, or sent to, the name of before is not for this board.
void Bridge::leave_for_another(Time now, Effects& out) {
    const auto stored = stored_name();
    out.log(Level::kWarning, "the board at this port has another name; beginning anew with that",
            {{"board", name()}, {"its name", stored.empty() ? "none" : stored}});
    port_.identified(traits(), out);
    values_.hurry(now);
    publish_values(now, out);
    leaving_ = true;
    session::Actions actions;
    board_.session.link_down(now, actions);
    perform(actions, now, out);
    // The board of that name may be at another port by now, where it is online.
    const bool of_port = !named_by_board_;
    if (announcer_->may_publish() && (!was_away_ || of_port)) {
        announcer_->goodbye(now, out);
        if (of_port) withdraw(out);
    }
    out.begin_anew = true;
}

// Another agent has the name that a board once had here.
void Bridge::yield_name(Effects& out) {
    if (!out.fatal || out.fatal->status != program::kExitNameConflict) return;
    if (!named_by_board_ || session().accepts_requests()) return;
    out.log(Level::kWarning, "the board of this name is at another port; waiting for one here",
            {{"board", name()}});
    out.fatal.reset();
    leaving_ = true;
    out.begin_anew = true;
}

// A name that was given stays, whichever board is at the port. `flashed`: it was away to be changed. A lender
// may lend another one.
void Bridge::compare_with_first(bool flashed, Time now, Effects& out) {
    const FirstBoard present{traits(), letters()};
    if (!first_board_ || flashed || options_.lent) first_board_ = present;
    std::string warning;
    if (present != *first_board_)
        warning =
            "another board than at first is at this port: " + in_words(present.traits, present.services) +
            "; it was " + in_words(first_board_->traits, first_board_->services) +
            ". If that is right, start the agent again";
    if (std::exchange(other_board_, warning) != warning && !warning.empty())
        out.log(Level::kWarning, warning);
    show_warnings(now);
}

void Bridge::unreached(model::StateReason reason, const std::string& why, model::LinkInfo link, Time now,
                       Effects& out) {
    // link_down() has said how a board went that was here.
    if (port_.phase() != PortLoan::Phase::kOurs || (found_ && reason == model::StateReason::kUnplugged))
        return;
    unreached_ = why;
    if (!found_) describer_.link_opened(std::move(link));
    announce_unreached(reason, now, out);
}

void Bridge::announce_unreached(model::StateReason reason, Time now, Effects& out) {
    if (!announcer_) {
        if (!options_.announce_unreached || options_.name.empty()) return;
        name_unanswered(now, out);
    }
    announcer_->set_state(model::BoardState::kLost, reason, now, out);
    show_warnings(now);
}

void Bridge::name_unanswered(Time now, Effects& out) {
    board_.name = options_.name.empty() ? name_of_port() : options_.name;
    name_board(now, out);
    out.board_known = true;
    describe_again(now);
}

// A port's name that no board has any more: catalogues forget it.
void Bridge::withdraw(Effects& out) const {
    for (const auto& topic : {board_.topics.description(name()), board_.topics.state(name()),
                              board_.topics.properties(name()), board_.topics.values(name())})
        out.publish.push_back({member::retained(topic), mqtt::Priority::kAnnouncement});
}

void Bridge::show_warnings(Time now) {
    std::vector<std::string> warnings;
    for (const auto& text : {unreached_, other_board_, restarts_.text(), context_.warning()})
        if (!text.empty()) warnings.push_back(text.substr(0, model::kMaxWarningBytes));
    if (describer_.note_warnings(std::move(warnings))) describe_again(now);
}

// True: it gets its line in the log.
bool Bridge::note_restart(Time now) {
    return restarts_.restarted(now);
}

void Bridge::tick_restarts(Time now, Effects& out) {
    if (!restarts_.tick(now)) return;
    if (restarts_.to_log()) out.log(Level::kWarning, "board " + restarts_.text());
    show_warnings(now);
}

}  // namespace asip::agent
