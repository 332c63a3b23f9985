// SPDX-License-Identifier: Apache-2.0
#include "asip/catalogue/bus_view.hpp"

#include <algorithm>
#include <utility>

#include "asip/model/names.hpp"
#include "asip/random.hpp"
#include "asip/text/printable.hpp"

namespace asip::catalogue {
namespace {

using bus::TopicKind;

Catalogue::Options options_for(UnitsOf units_of) {
    Catalogue::Options options;
    options.max_boards = BusView::kMaxBoards;
    options.units_of = std::move(units_of);
    options.hash_seed = system_random()();
    return options;
}

bool is_announcement(TopicKind kind) {
    return kind == TopicKind::kBoardNames || kind == TopicKind::kServiceNames || kind == TopicKind::kState ||
           kind == TopicKind::kDescription;
}

/// Why no program can use the message; empty where it is only older than what is known.
std::string fault_of(const mqtt::Message& message, Refusal refusal) {
    switch (refusal) {
        case Refusal::kBadName:
            return "a name that is not valid";
        case Refusal::kBadState:
            return "not a state: " + text::printable(message.payload.substr(0, 200));
        case Refusal::kTooMany:
            return "more than " + std::to_string(BusView::kMaxBoards) + " boards";
        case Refusal::kWrongBoard: {
            const auto description = model::parse_description(message.payload);
            return description ? "describes another board: " + description->board : description.error();
        }
        case Refusal::kTooLong:
        case Refusal::kMalformed: {
            const auto description = model::parse_description(message.payload);
            return description ? std::string(to_text(refusal)) : description.error();
        }
        default:
            return {};
    }
}

}  // namespace

BusView::BusView(bus::Topics topics, UnitsOf units_of)
    : topics_(std::move(topics)), catalogue_(options_for(std::move(units_of))) {}

std::string BusView::apply(const mqtt::Message& message, Time now) {
    const auto topic = topics_.parse(message.topic);
    if (!topic) {
        if (message.topic.starts_with(topics_.root() + "/servicebus/") && !message.payload.empty())
            judge(message, {}, Refusal::kBadName);
        return {};
    }
    if (!is_announcement(topic->kind)) return {};
    std::string board(topic->kind == TopicKind::kBoardNames ? without_line_end(message.payload)
                                                            : topic->board);
    const auto applied = catalogue_.apply(
        {topic->kind, topic->board, message.payload, message.retain, message.expiry_seconds}, now);
    judge(message, board, applied.refused);
    if (topic->kind == TopicKind::kBoardNames && applied.refused == Refusal::kBadName) return {};
    return board;
}

void BusView::judge(const mqtt::Message& message, const std::string& board, std::optional<Refusal> refusal) {
    if (!refusal) {
        descriptions_.erase(board);
        refused_.erase(message.topic);
    } else if (auto fault = fault_of(message, *refusal); !fault.empty()) {
        if (refused_.size() < kMaxRefused || refused_.contains(message.topic))
            refused_[message.topic] = std::move(fault);
    }
}

void BusView::judge_leases(Time now) {
    for (auto& event : catalogue_.expire(now)) {
        if (!event.is_change()) continue;
        if (event.kind == Event::Kind::kForgotten) descriptions_.erase(event.board);
        if (expired_.size() < kMaxBoards) expired_.insert(std::move(event.board));
    }
}

std::set<std::string> BusView::expired(Time now) {
    judge_leases(now);
    return std::exchange(expired_, {});
}

std::vector<bus::BoardItem> BusView::boards(bus::Query query, Instant now) {
    judge_leases(now.time);
    query.find = bus::Find::kBoards;
    query.brief = false;
    query.limit = bus::Query::kMaxPage;
    std::vector<bus::BoardItem> all;
    do {
        auto page = catalogue_.find(query, now);
        if (!page) break;
        std::move(page->boards.begin(), page->boards.end(), std::back_inserter(all));
        query.cursor = page->cursor;
    } while (!query.cursor.empty());
    return all;
}

std::vector<bus::ServiceItem> BusView::services(bus::Query query, Instant now) {
    judge_leases(now.time);
    query.find = bus::Find::kServices;
    query.limit = bus::Query::kMaxPage;
    std::vector<bus::ServiceItem> all;
    do {
        auto page = catalogue_.find(query, now);
        if (!page) break;
        std::move(page->services.begin(), page->services.end(), std::back_inserter(all));
        query.cursor = page->cursor;
    } while (!query.cursor.empty());
    return all;
}

std::optional<bus::BoardItem> BusView::board(std::string_view name, Instant now) {
    judge_leases(now.time);
    return catalogue_.board(name, now, true);
}

const model::Description* BusView::description(const std::string& name) const {
    const auto [place, fresh] = descriptions_.try_emplace(name);
    if (fresh) {
        const auto item = catalogue_.board(name, {}, true);
        if (item && !item->description.empty()) {
            if (auto parsed = model::parse_description(item->description)) place->second = std::move(*parsed);
        }
    }
    return place->second ? &*place->second : nullptr;
}

std::vector<std::string> BusView::names() const {
    std::vector<std::string> names;
    catalogue_.for_each(
        [&](std::string_view name, model::BoardState, model::StateReason) { names.emplace_back(name); });
    std::sort(names.begin(), names.end());
    return names;
}

Instant instant_now() {
    return {Clock::now(), text::wall_now()};
}

}  // namespace asip::catalogue
