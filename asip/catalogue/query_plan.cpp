// SPDX-License-Identifier: Apache-2.0
#include "asip/catalogue/query_plan.hpp"

#include <algorithm>
#include <array>

#include "asip/bus/registry/board_match.hpp"

namespace asip::catalogue {
namespace {

using model::BoardState;

constexpr std::array<BoardState, kStates> kAllStates{BoardState::kOnline, BoardState::kOffline,
                                                     BoardState::kLost, BoardState::kSleeping,
                                                     BoardState::kUpdating};

constexpr std::array<std::pair<std::string_view, QueryPlan::Sort>, 5> kSorts{
    {{"name", QueryPlan::Sort::kName},
     {"state", QueryPlan::Sort::kState},
     {"chip", QueryPlan::Sort::kChip},
     {"sketch", QueryPlan::Sort::kSketch},
     {"last_seen", QueryPlan::Sort::kLastSeen}}};

std::optional<Cursor> read_cursor(std::string_view text) {
    const std::size_t first = text.find('/');
    if (first == std::string_view::npos) return std::nullopt;
    const std::size_t second = text.find('/', first + 1);
    if (second == std::string_view::npos) return std::nullopt;
    return Cursor{std::string(text.substr(0, first)), std::string(text.substr(first + 1, second - first - 1)),
                  std::string(text.substr(second + 1))};
}

template <class Value>
void add_once(std::vector<Value>& values, Value value) {
    if (std::find(values.begin(), values.end(), value) == values.end()) values.push_back(value);
}

std::string read_sort(std::string_view text, QueryPlan& plan) {
    plan.descending = !text.empty() && text.front() == '-';
    if (plan.descending) text.remove_prefix(1);
    if (text.empty()) return {};
    for (const auto& [word, sort] : kSorts) {
        if (word == text) {
            plan.sort = sort;
            return {};
        }
    }
    return "sort: \"" + std::string(text) + "\" is none of name, state, chip, sketch, last_seen";
}

std::string read_states(const std::vector<std::string>& words, QueryPlan& plan) {
    for (const std::string& word : words) {
        const auto state = model::board_state_from_text(word);
        if (!state) return "state: \"" + word + "\" is none of online, offline, lost, sleeping, updating";
        add_once(plan.states, *state);
    }
    if (words.empty()) plan.states.assign(kAllStates.begin(), kAllStates.end());
    return {};
}

}  // namespace

Expected<QueryPlan> make_query_plan(const bus::Query& query, const KindTable& kinds, const View* view) {
    if (query.find == bus::Find::kHistory) return fail("the catalogue keeps no history");
    if (query.find == bus::Find::kModels) return fail("the catalogue keeps no models");
    if (query.find == bus::Find::kValues) return fail("the catalogue keeps no values");
    QueryPlan plan{query, view};
    if (auto error = read_sort(query.sort, plan); !error.empty()) return fail(error);
    if (auto error = read_states(query.state, plan); !error.empty()) return fail(error);
    plan.without_states = query;
    plan.without_states.state.clear();
    if (!query.capability.empty() && bus::capability_bit(query.capability) == 0) {
        return fail("capability: \"" + query.capability + "\" is none of digital, analog, pwm");
    }
    if (!query.cursor.empty()) {
        plan.cursor = read_cursor(query.cursor);
        if (!plan.cursor) return fail("cursor: not one of this registry's");
    }
    plan.limit = std::clamp<std::size_t>(query.limit, 1, bus::Query::kMaxPage);
    plan.by_service = bus::asks_for_services(query);
    for (const std::string& name : query.kind) {
        if (Kind* kind = kinds.find(name)) add_once(plan.kinds, kind);
    }
    return plan;
}

bool QueryPlan::board_matches(const Board& b) const {
    bus::BoardFacts facts{b.name,
                          {},
                          {},
                          {},
                          b.pins == nullptr ? 0 : b.pins->capabilities,
                          b.labels() == nullptr ? nullptr : &b.labels()->labels};
    if (b.firmware != nullptr) {
        facts.chip = b.firmware->chip;
        facts.sketch = b.firmware->sketch;
    }
    return bus::matches_board(without_states, facts) &&
           (view == nullptr || !view->board || view->board(b.name));
}

bool QueryPlan::service_matches(const Board& b, const ServicesPart& part, std::size_t index) const {
    const Service& service = part.services[index];
    if (!sees(b, service)) return false;
    const auto has_unit = [&](const std::string& unit) {
        const bool standard = !service.model.empty() || service.id == '\0';
        const auto& units = service.kind->units;
        return (standard && std::find(units.begin(), units.end(), unit) != units.end()) ||
               std::any_of(part.own_units.begin(), part.own_units.end(),
                           [&](const auto& own) { return own.first == index && own.second == unit; });
    };
    return bus::matches_service(query, service.name, service.kind->name, has_unit);
}

bool QueryPlan::some_service_matches(const Board& b) const {
    if (b.services == nullptr) return false;
    for (std::size_t i = 0; i < b.services->services.size(); ++i) {
        if (service_matches(b, *b.services, i)) return true;
    }
    return false;
}

bool QueryPlan::counted_by_index() const {
    return view == nullptr && query.board.empty() && query.service.empty() && query.chip.empty() &&
           query.sketch.empty() && query.unit.empty() && query.capability.empty() && query.labels.empty() &&
           (query.kind.size() <= 1 || query.find == bus::Find::kServices);
}

}  // namespace asip::catalogue
