// SPDX-License-Identifier: Apache-2.0
// Changes of the catalogue: told to watchers, to the history, and to people.
#include "asip/program/log.hpp"
#include "registry/registry.hpp"

namespace asip::registry {

namespace log = program::log;

void Registry::complete() {
    queries_.set_settling(false);
    feed_.complete();
    if (history_ != nullptr) history_->complete(catalogue_, now_);
    if (choice_) choice_->complete([this] { return board_names(); });
    if (notifies_ && !notices_) notices_.emplace(id_);
    log::write(log::Level::kInfo, "catalogue is complete", {{"boards", catalogue_.size()}});
    if (auto reset = feed_.reset(now_, 0)) publish(*reset);
    // The broker has those of before, and what waits for an answer goes first.
    const bool first = statistics_.counts.connections == 1;
    first ? publish_statistics() : statistics_.postpone(now_.time);
}

void Registry::handle(const std::vector<Event>& events, bool decided_here) {
    for (const Event& event : events) {
        switch (event.kind) {
            case Event::Kind::kGhost:
                tidier_.ghost(event.board, now_.time);
                break;
            case Event::Kind::kListen:
                names_only_.add(event.board, now_.time);
                break;
            case Event::Kind::kUnlisten:
                names_only_.remove(event.board);
                break;
            default:
                change(event);
                if (event.kind == Event::Kind::kForgotten && decided_here) tidier_.forgotten(event.board);
        }
    }
}

void Registry::change(const Event& event) {
    if (history_ != nullptr) history_->change(event, now_);
    if (choice_) choice_->changed(event.board);
    if (notices_) note_loss(event);
    if (event.kind == Event::Kind::kConflict) {
        log::warning("two agents claim one board; stop one or give it another --name",
                     {{"board", event.board}});
    }
    const bool overrun_before = feed_.overrun();
    feed_.change(event);
    if (feed_.overrun() && !overrun_before)
        log::warning("changes come faster than the broker accepts them; watchers will have to query again");
    publish_changes();
}

void Registry::note_loss(const Event& event) {
    using enum model::BoardState;
    if (event.kind == Event::Kind::kForgotten) return notices_->forgotten(event.board);
    if (event.kind != Event::Kind::kState) return;
    if (event.state == kLost) {
        // "HOST CLIENT", or one of them.
        const auto item = catalogue_.board(event.board, now_);
        const auto blank = item ? item->agent.find(' ') : std::string::npos;
        notices_->lost(event.board, blank == std::string::npos ? std::string() : item->agent.substr(0, blank),
                       event.reason, now_);
    } else if (event.was == kLost && event.state != kOffline) {
        notices_->back(event.board, now_);
    }
}

void Registry::publish_changes() {
    while (auto event = feed_.next(catalogue_, now_, port_.queued())) {
        publish(*event);
        ++statistics_.counts.events;
    }
}

void Registry::publish(const bus::ChangeEvent& event) {
    port_.publish(mqtt::Message{.topic = topics_.registry_events(id_), .payload = bus::encode(event)});
}

void Registry::publish_statistics() {
    if (history_ != nullptr) {
        statistics_.counts.history_dropped = history_->dropped_rows();
        statistics_.counts.history_fault = history_->fault();
    }
    if (values_ != nullptr) {
        statistics_.counts.values_kept = values_->kept();
        statistics_.counts.values_lost = values_->lost();
        statistics_.counts.values_fault = values_->fault();
    }
    port_.publish(mqtt::Message{.topic = topics_.registry_stats(id_),
                                .payload = statistics_.document(catalogue_, feed_.epoch(), feed_.seq(), now_),
                                .retain = true});
}

}  // namespace asip::registry
