// SPDX-License-Identifier: Apache-2.0
#include "agent/bridge/bridge.hpp"

#include <algorithm>
#include <ctime>
#include <utility>

namespace asip::agent {

using program::log::Level;

namespace {

int local_second_of_day() {
    const auto now = std::time(nullptr);
    std::tm local{};
    ::localtime_r(&now, &local);
    return local.tm_hour * 3600 + local.tm_min * 60 + local.tm_sec;
}

}  // namespace

Bridge::Bridge(BridgeOptions options, model::ModelSet models, Random random)
    : options_(std::move(options)),
      models_(std::move(models)),
      random_(std::move(random)),
      board_{bus::Topics(options_.topic_root), session::BoardSession(options_.session, random_)},
      age_(random_),
      values_(board_, age_),
      safety_(board_, statistics_, values_),
      periods_(options_.reports),
      control_(board_, age_, statistics_, safety_, periods_, values_, latch_),
      context_(board_, options_.context),
      labels_(board_, options_.labels),
      describer_(board_, models_, options_.reports),
      links_(
          {.board = board_,
           .values = values_,
           .ready = [this] { return session().accepts_requests() && found_ && !safety_.pending() && !ends_; },
           .user = options_.bus_user,
           .second_of_day = options_.second_of_day ? options_.second_of_day : &local_second_of_day},
          random_) {}

// --- the board's side

void Bridge::link_up(session::LinkTraits traits, model::LinkInfo link, Time now, Effects& out) {
    traits.perhaps_another_board = options_.lent;
    describer_.link_opened(std::move(link));
    // An open port does not say yet which board is behind it.
    if (found_ || !options_.name.empty()) unreached_.clear();
    statistics_.link_opened(now);
    session::Actions actions;
    board_.session.link_up(traits, now, actions);
    perform(actions, now, out);
}

void Bridge::link_down(const std::string& why, Time now, Effects& out) {
    // A port that opens and closes with nothing behind it loses no board.
    const bool heard = session().counters().bytes_in > 0;
    // Nor does one that is lost already.
    const bool lost = name_claimed_ && !session().accepts_requests();
    const bool news = heard && !lost;
    out.log(news && note_restart(now) ? Level::kWarning : Level::kDebug, "board lost", {{"why", why}});
    was_away_ = true;
    // A connection that this agent closes because the board is silent is not the reason.
    const bool closed_here =
        describer_.link().kind == "tcp" && announcer_ && announcer_->state() == model::BoardState::kLost;
    if (options_.lent && announcer_) {
        unreached_ = why;
        show_warnings(now);
    }
    if (announcer_ && !closed_here)
        announcer_->set_state(model::BoardState::kLost, model::StateReason::kUnplugged, now, out);
    safety_.board_gone(out);
    session::Actions actions;
    board_.session.link_down(now, actions);
    perform(actions, now, out);
    // It may have lost its power, or another one comes back.
    values_.away();
}

void Bridge::not_watched(Time since, Time now) {
    board_.session.not_watched(since, now);
    links_.not_watched(since, now);
}

void Bridge::receive(std::string_view bytes, Time now, Effects& out) {
    statistics_.received(bytes);
    context_.line().received(bytes, now);
    session::Actions actions;
    board_.session.receive(bytes, now, actions);
    perform(actions, now, out);
    send_safe_lines(now, out);
    send_periods(now, out);
    if (port_.phase() == PortLoan::Phase::kMakingSafe) tick_port(now, out);
    values_.tick(now);
    run_links(now, out);
}

void Bridge::line_rate_set(bool ok, Time now, Effects& out) {
    session::Actions actions;
    board_.session.line_rate_set(ok, now, actions);
    perform(actions, now, out);
}

void Bridge::send_safe_lines(Time now, Effects& out) {
    if (!safety_.pending() || leaving_) return;
    session::Actions actions;
    safety_.send(now, actions);
    perform(actions, now, out);
}

void Bridge::send_periods(Time now, Effects& out) {
    if (const auto due = periods_.next_deadline(); !due || now < *due || leaving_) return;
    session::Actions actions;
    periods_.tick(board_.session, now, actions);
    perform(actions, now, out);
}

void Bridge::publish_values(Time now, Effects& out) {
    const auto others = out.publish.size();
    if (announcer_ && announcer_->is_announced() && name_claimed_ && !leaving_)
        values_.publish(announcer_->session(), now, out);
    // Links wait for the document where a contact makes it.
    if (out.publish.size() > others && values_.has_contacts())
        std::rotate(out.publish.begin(), out.publish.begin() + static_cast<std::ptrdiff_t>(others),
                    out.publish.end());
    if (name_claimed_ && may_publish()) context_.publish_line(now, out);
}

void Bridge::perform(session::Actions& actions, Time now, Effects& out) {
    for (auto& action : actions) {
        if (const auto* write = std::get_if<session::Write>(&action)) {
            statistics_.sent(write->bytes);
            context_.line().sent(write->bytes, now);
        }
        if (std::holds_alternative<session::Write>(action) ||
            std::holds_alternative<session::SetLineRate>(action)) {
            if (!leaving_) out.link.push_back(std::move(action));
            continue;
        }
        std::visit(
            [&](const auto& known) {
                using Kind = std::decay_t<decltype(known)>;
                if constexpr (!std::is_same_v<Kind, session::Write> &&
                              !std::is_same_v<Kind, session::SetLineRate>)
                    on_action(known, now, out);
            },
            action);
    }
}

void Bridge::start_publishing(Effects& out) {
    if (!announcer_ || !announcer_->may_publish()) return;
    if (!std::exchange(name_claimed_, true)) out.name_claimed = true;
    for (const auto& line : offline_values_.take(out))
        context_.publish(line, context_.decode(line), out);
}

// --- time

void Bridge::publish_statistics(const mqtt::Counters& bus, Time now, Effects& out) {
    if (!announcer_ || !announcer_->may_publish()) return;
    out.publish.push_back(
        {mqtt::Message{.topic = board_.topics.stats(name()),
                       .payload = statistics_.document(
                           {board_.session, bus, name(), announcer_->session(), control_.forgotten_answers(),
                            safety_.holds().size(), periods_, context_.undecoded()},
                           now)},
         mqtt::Priority::kContext});
}

void Bridge::tick(Time now, Effects& out) {
    session::Actions actions;
    board_.session.tick(now, actions);
    perform(actions, now, out);
    safety_.tick(now, out);
    send_safe_lines(now, out);
    send_periods(now, out);
    tick_port(now, out);
    tick_restarts(now, out);
    labels_.tick(now, out);
    if (announcer_) announcer_->tick(now, out);
    yield_name(out);
    start_publishing(out);
    values_.tick(now);
    run_links(now, out);
}

std::optional<Time> Bridge::next_deadline() const {
    auto deadline = board_.session.next_deadline();
    const bool announced = name_claimed_ && announcer_ && announcer_->is_announced();
    const auto values = announced ? values_.next_deadline() : std::nullopt;
    const auto line = name_claimed_ && may_publish() ? context_.line().next_deadline() : std::nullopt;
    for (const auto& other :
         {values, line, safety_.next_deadline(), port_.next_deadline(), periods_.next_deadline(),
          restarts_.next_deadline(), labels_.next_deadline(), links_.next_deadline(may_publish()),
          rests_until_, announcer_ ? announcer_->next_deadline() : std::nullopt})
        if (other && (!deadline || *other < *deadline)) deadline = other;
    return deadline;
}

bool Bridge::release_holds(Time now, Effects& out) {
    ends_ = true;
    const bool pending = safety_.release_all();
    send_safe_lines(now, out);
    links_.hurry(now);
    links_.tell(may_publish(), now, out);
    return pending && session().accepts_requests();
}

void Bridge::leave_line(Time now, Effects& out) {
    session::Actions actions;
    board_.session.leave(session::Leave::kOnceQuiet, now, actions);
    perform(actions, now, out);
}

void Bridge::goodbye(Time now, Effects& out) {
    session::Actions actions;
    board_.session.link_down(now, actions);
    perform(actions, now, out);
    values_.hurry(now);
    publish_values(now, out);
    if (!announcer_) return;
    const bool only_a_port = !found_ && options_.name.empty() && announcer_->may_publish();
    announcer_->goodbye(now, out);
    if (only_a_port) withdraw(out);
}

}  // namespace asip::agent
