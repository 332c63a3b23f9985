#include "registry/catalogue/query_plan.hpp"

#include <algorithm>
#include <array>

#include "asip/bus/pattern.hpp"

namespace asip::registry {
namespace {

using model::BoardState;

constexpr std::array<BoardState, kStates> kAllStates{
    BoardState::Online, BoardState::Offline, BoardState::Lost, BoardState::Sleeping, BoardState::Updating};

constexpr std::array<std::pair<std::string_view, QueryPlan::Sort>, 5> kSorts{
    {{"name", QueryPlan::Sort::kName},
     {"state", QueryPlan::Sort::kState},
     {"chip", QueryPlan::Sort::kChip},
     {"sketch", QueryPlan::Sort::kSketch},
     {"last_seen", QueryPlan::Sort::kLastSeen}}};

unsigned capability_bit(std::string_view word) {
    if (word == "digital") return 1;
    if (word == "analog") return 2;
    if (word == "pwm") return 4;
    return 0;
}

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

Expected<QueryPlan> make_query_plan(const bus::Query& query, const KindTable& kinds) {
    if (query.find == bus::Find::kHistory) return fail("the catalogue keeps no history");
    QueryPlan plan{query};
    if (auto error = read_sort(query.sort, plan); !error.empty()) return fail(error);
    if (auto error = read_states(query.state, plan); !error.empty()) return fail(error);
    plan.capability = capability_bit(query.capability);
    if (plan.capability == 0 && !query.capability.empty()) {
        return fail("capability: \"" + query.capability + "\" is none of digital, analog, pwm");
    }
    if (!query.cursor.empty()) {
        plan.cursor = read_cursor(query.cursor);
        if (!plan.cursor) return fail("cursor: not one of this registry's");
    }
    plan.limit = std::clamp<std::size_t>(query.limit, 1, bus::Query::kMaxPage);
    plan.by_service = !query.kind.empty() || !query.service.empty() || !query.unit.empty();
    for (const std::string& name : query.kind) {
        if (Kind* kind = kinds.find(name)) add_once(plan.kinds, kind);
    }
    return plan;
}

bool QueryPlan::board_matches(const Board& b) const {
    if (!bus::matches_pattern(query.board, b.name)) return false;
    if (!query.chip.empty() &&
        (b.firmware == nullptr || !bus::matches_pattern(query.chip, b.firmware->chip))) {
        return false;
    }
    if (!query.sketch.empty() &&
        (b.firmware == nullptr || !bus::matches_pattern(query.sketch, b.firmware->sketch))) {
        return false;
    }
    return capability == 0 || (b.pins != nullptr && (b.pins->capabilities & capability) != 0);
}

bool QueryPlan::service_matches(const ServicesPart& part, std::size_t index) const {
    const Service& service = part.services[index];
    if (!query.kind.empty() && std::find(kinds.begin(), kinds.end(), service.kind) == kinds.end())
        return false;
    if (!bus::matches_pattern(query.service, service.name)) return false;
    if (query.unit.empty()) return true;
    const auto& units = service.kind->units;
    if (std::find(units.begin(), units.end(), query.unit) != units.end()) return true;
    return std::any_of(part.own_units.begin(), part.own_units.end(),
                       [&](const auto& own) { return own.first == index && own.second == query.unit; });
}

bool QueryPlan::some_service_matches(const Board& b) const {
    if (b.services == nullptr) return false;
    for (std::size_t i = 0; i < b.services->services.size(); ++i) {
        if (service_matches(*b.services, i)) return true;
    }
    return false;
}

bool QueryPlan::counted_by_index() const {
    return query.board.empty() && query.service.empty() && query.chip.empty() && query.sketch.empty() &&
           query.unit.empty() && query.capability.empty() &&
           (query.kind.size() <= 1 || query.find == bus::Find::kServices);
}

}  // namespace asip::registry
