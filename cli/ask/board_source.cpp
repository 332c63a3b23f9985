// SPDX-License-Identifier: Apache-2.0
#include "cli/ask/board_source.hpp"

#include <algorithm>

#include "asip/model/names.hpp"
#include "asip/text/nearest.hpp"

namespace asip::cli {
namespace {

/// For all pages of one answer: ten times what the largest catalogues need. A registry that goes on behind
/// them would go on for ever.
constexpr std::size_t kMaxPagesBytes = std::size_t{1} << 30;
constexpr std::size_t kMaxPages = 100'000;
constexpr std::size_t kMaxRefusalBytes = 1000;

bool holds_nothing(const bus::Answer& page) {
    return page.boards.empty() && page.services.empty() && page.kept.empty() &&
           (!page.brief || page.brief->empty());
}

/// Names are printed as they are, and become parts of topics.
void leave_out_invalid_names(bus::Answer& answer) {
    const auto invalid = [](const auto& item) { return !model::valid_name(item.board); };
    std::erase_if(answer.boards, invalid);
    if (answer.brief) std::erase_if(answer.brief->rows(), invalid);
    std::erase_if(answer.services, [&invalid](const bus::ServiceItem& service) {
        return invalid(service) || !model::valid_name(service.name);
    });
    for (auto& board : answer.boards)
        std::erase_if(board.services, [](const auto& service) { return !model::valid_name(service.name); });
}

}  // namespace

std::vector<std::string> KnownBoard::service_names() const {
    std::vector<std::string> result;
    for (const auto& service : item.services)
        result.push_back(service.name);
    return result;
}

std::string KnownBoard::why_no_description() const {
    return description_fault.empty() ? "publishes no description"
                                     : "publishes a description that is not valid: " + description_fault;
}

BoardSource::BoardSource(const Environment& environment, BusSession& session)
    : environment_(environment), session_(session) {
    if (environment.from_bus) return;
    registries_ =
        session_.subscribe(environment.topics.registry_state("+"), [this](const mqtt::Message& message) {
            const auto ref = environment_.topics.parse(message.topic);
            if (ref && message.payload == "online") online_registries_.emplace_back(ref->board);
        });
}

Outcome<bus::Answer> BoardSource::ask(const bus::Query& query) {
    const auto topic = registry_.empty() ? environment_.topics.any_registry_query()
                                         : environment_.topics.registry_query(registry_);
    std::optional<Expected<bus::Answer>> answer;
    const auto request = session_.ask(topic, bus::encode(bus::RegistryRequest{query, {}, {}}),
                                      [this, &answer](const mqtt::Message& message) {
                                          if (answer) return;
                                          answered_bytes_ += message.payload.size();
                                          answer = bus::parse_answer(message.payload);
                                      });
    const auto asked = Clock::now();
    const auto answered = [&answer] { return answer.has_value(); };
    const bool soon =
        session_.run_until(answered, asked + std::min<Duration>(kAnswerPatience, environment_.timeout));
    const auto mark = soon || !registry_.empty() ? BusSession::Mark{} : session_.mark_retained();
    const auto none_there = [&] {
        const auto waited = Clock::now() - mark.passed_at().value_or(asked);
        return registry_.empty() && online_registries_.empty() &&
               waited >= (mark.passed() ? kRetainedPatience : kMarkPatience);
    };
    const auto deadline = Clock::now() + environment_.timeout;
    session_.run_until([&] { return answer || none_there(); }, deadline);
    if (session_.stopped()) return interrupted();
    if (!answer)
        return tl::unexpected(
            session_.unanswered(online_registries_.empty() ? "no registry" : "registry silent"));
    if (!*answer)
        return failure(program::kExitNoAnswer, "registry answers what cannot be read: " + answer->error());
    if (!(*answer)->refused.empty())
        return failure(program::kExitFailure, (*answer)->error.substr(0, kMaxRefusalBytes));
    registry_ = (*answer)->registry;
    leave_out_invalid_names(**answer);
    return std::move(**answer);
}

Outcome<bus::Answer> BoardSource::ask_all_pages(bus::Query query) {
    query.limit = bus::Query::kMaxPage;
    const auto patience = Clock::now() + environment_.timeout;
    auto all = ask(query);
    while (all && all->settling && Clock::now() < patience && !session_.stopped()) {
        session_.run_for(std::chrono::milliseconds(100));
        all = ask(query);
    }
    if (!all) return all;
    answered_bytes_ = 0;
    for (std::size_t pages = 1; !all->cursor.empty(); ++pages) {
        query.cursor = all->cursor;
        auto page = ask(query);
        if (!page) return page;
        if (pages > kMaxPages || goes_on_for_ever(*page, query.cursor, holds_nothing(*page)))
            return without_end();
        std::move(page->boards.begin(), page->boards.end(), std::back_inserter(all->boards));
        if (all->brief && page->brief)
            for (const auto& row : page->brief->rows())
                all->brief->add(row);
        std::move(page->services.begin(), page->services.end(), std::back_inserter(all->services));
        std::move(page->kept.begin(), page->kept.end(), std::back_inserter(all->kept));
        all->cursor = page->cursor;
    }
    return all;
}

bool BoardSource::goes_on_for_ever(const bus::Answer& page, const std::string& cursor, bool empty) const {
    return !page.cursor.empty() && (empty || page.cursor == cursor || answered_bytes_ > kMaxPagesBytes);
}

tl::unexpected<Failure> BoardSource::without_end() const {
    return failure(program::kExitFailure,
                   "the answer of registry " + registry_ + " has no end; asipctl --from-bus does without it");
}

void BoardSource::without_registry(const std::string& why) {
    no_registry_ = true;
    environment_.note(
        why == "no registry"
            ? "no registry answers; reading the bus itself (start asip-registry, or give --from-bus)"
            : why + "; reading the bus itself");
}

std::string BoardSource::find_registry(bool tell) {
    if (!asks_registry()) return {};
    bus::Query query;
    query.limit = 1;
    const auto answer = ask(query);
    if (tell && !answer && !session_.stopped() && !session_.lost()) without_registry(answer.error().text);
    return registry_;
}

Outcome<std::vector<bus::BoardItem>> BoardSource::boards(bus::Query query) {
    query.find = bus::Find::kBoards;
    if (asks_registry()) {
        auto answer = ask_all_pages(query);
        if (answer) return std::move(answer->boards);
        if (answer.error().status != program::kExitNoAnswer) return tl::unexpected(answer.error());
        without_registry(answer.error().text);
    }
    read_bus(true);
    if (const auto heard = session_.heard_all(); !heard) return tl::unexpected(heard.error());
    return bus().boards(std::move(query), catalogue::instant_now());
}

Outcome<std::vector<KnownBoard>> BoardSource::known_boards(bus::Query query) {
    query.full = true;
    auto items = boards(std::move(query));
    if (!items) return tl::unexpected(items.error());
    std::vector<KnownBoard> result;
    result.reserve(items->size());
    for (auto& item : *items)
        result.push_back(known(std::move(item)));
    return result;
}

Outcome<bus::BriefRows> BoardSource::brief_boards(bus::Query query) {
    std::vector<bus::BoardItem> items;
    if (asks_registry()) {
        query.find = bus::Find::kBoards;
        query.brief = true;
        auto answer = ask_all_pages(query);
        if (answer && answer->brief) return std::move(*answer->brief);
        if (answer)
            items = std::move(answer->boards);  // a registry that knows no brief queries
        else if (answer.error().status != program::kExitNoAnswer)
            return tl::unexpected(answer.error());
        else
            without_registry(answer.error().text);
    }
    if (!asks_registry()) {
        auto found = boards(query);
        if (!found) return tl::unexpected(found.error());
        items = std::move(*found);
    }
    return bus::brief_of(items);
}

Outcome<std::vector<bus::ServiceItem>> BoardSource::services(bus::Query query) {
    if (asks_registry()) {
        query.find = bus::Find::kServices;
        auto answer = ask_all_pages(query);
        if (answer) return std::move(answer->services);
        if (answer.error().status != program::kExitNoAnswer) return tl::unexpected(answer.error());
        without_registry(answer.error().text);
    }
    read_bus(true);
    if (const auto heard = session_.heard_all(); !heard) return tl::unexpected(heard.error());
    return bus().services(std::move(query), catalogue::instant_now());
}

void BoardSource::on_announcement(
    std::function<void(const std::string& board, const std::string& session)> handler) {
    // The view shows one of two agents with one name.
    session_.on_board(
        [this, handler = std::move(handler)](const std::string& board, const mqtt::Message* said) {
            if (said == nullptr || said->retain || said->topic != environment_.topics.description(board))
                return;
            if (const auto description = model::parse_description(said->payload))
                handler(board, description->session);
        });
}

void BoardSource::read_bus(bool probe) {
    if (!std::exchange(bus_read_, true)) {
        session_.caller().watch_all();
        session_.wait_retained();
    }
    if (!probe || session_.stopped()) return;
    session_.publish(environment_.topics.probe(), "");
    session_.run_for(kProbeWindow);
}

std::optional<KnownBoard> BoardSource::retained_board(const std::string& name) {
    session_.caller().watch(name);
    const auto here = [&] {
        const auto known = bus().board(name, catalogue::instant_now());
        return known && !known->description.empty() && session_.caller().heard_of(name);
    };
    session_.wait_retained(here);
    if (bus().description(name) == nullptr) return std::nullopt;
    return known(*bus().board(name, catalogue::instant_now()));
}

Outcome<KnownBoard> BoardSource::board(const std::string& name) {
    if (auto retained = retained_board(name)) return std::move(*retained);
    if (asks_registry() && !online_registries_.empty()) return board_in_full(name);
    session_.caller().watch_names(name);
    session_.publish(environment_.topics.probe(), name);
    session_.run_until([&] { return bus().description(name) != nullptr; }, Clock::now() + kProbeWindow);
    if (auto item = bus().board(name, catalogue::instant_now())) return known(std::move(*item));
    return unknown(name);
}

Outcome<KnownBoard> BoardSource::board_in_full(const std::string& name) {
    if (!asks_registry()) return board(name);
    bus::Query query;
    query.board = name;
    query.full = true;
    auto answer = ask(query);
    if (!answer) {
        if (answer.error().status != program::kExitNoAnswer) return tl::unexpected(answer.error());
        without_registry(answer.error().text);
        return board(name);
    }
    if (answer->boards.empty()) return unknown(name);
    return known(std::move(answer->boards.front()));
}

KnownBoard BoardSource::known(bus::BoardItem item) const {
    KnownBoard result{std::move(item), std::nullopt};
    if (result.item.description.empty()) {
        const auto& refused = bus().refused();
        const auto fault = refused.find(environment_.topics.description(result.item.board));
        if (fault != refused.end()) result.description_fault = fault->second;
        return result;
    }
    if (auto description = model::parse_description(result.item.description))
        result.description = std::move(*description);
    else
        result.description_fault = description.error();
    return result;
}

std::vector<std::string> BoardSource::names() {
    std::vector<std::string> result;
    if (asks_registry()) {
        bus::Query query;
        if (auto answer = ask_all_pages(query)) {
            for (auto& board : answer->boards)
                result.push_back(std::move(board.board));
            return result;
        }
        no_registry_ = true;
    }
    read_bus(false);
    return bus().names();
}

Outcome<KnownBoard> BoardSource::unknown(const std::string& name) {
    auto all = names();
    if (session_.stopped()) return interrupted();
    if (std::erase(all, name) > 0) {  // it came behind the question
        bus::Query query;
        query.board = name;
        auto late = known_boards(std::move(query));
        if (!late || !late->empty()) return late.map([](auto& boards) { return std::move(boards.front()); });
    }
    auto failed = no_such_board(name, all);
    return tl::unexpected(session_.unanswered(std::move(failed.text)));
}

Failure no_such_board(const std::string& name, const std::vector<std::string>& all) {
    const bool pattern = name.find_first_of("*?") != std::string::npos;
    const auto near = pattern ? std::string() : text::did_you_mean(name, all);
    auto text = pattern ? "no board is like " + name : "no board '" + name + "' on this bus" + near;
    if (all.empty())
        text += "; there is no board at all: is its asip-agent running?";
    else if (near.empty())
        text += "; see asipctl list";
    return {program::kExitNoAnswer, std::move(text)};
}

}  // namespace asip::cli
