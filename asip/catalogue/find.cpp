// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <tuple>

#include "asip/bus/pattern.hpp"
#include "asip/catalogue/catalogue_impl.hpp"
#include "asip/text/wall_time.hpp"

namespace asip::catalogue {

// Several sorted sets are read side by side.
void Catalogue::Impl::visit_candidates(const QueryPlan& plan,
                                       const std::function<bool(std::uint32_t slot)>& visit) const {
    struct Source {
        const SlotList* list;
        SlotList::Position at;
    };
    std::vector<Source> sources;
    const std::string_view prefix = plan.name_prefix();
    const bool from_cursor = plan.cursor && plan.in_order_of_names();
    const std::string_view from =
        std::max(from_cursor ? std::string_view(plan.cursor->board) : std::string_view(), prefix);
    const auto before = [&](std::uint32_t slot) { return board(slot).name < from; };
    const auto add = [&](const SlotList& list) {
        const auto at = from.empty() ? SlotList::Position{} : list.lower_bound(before);
        if (!list.at_end(at)) sources.push_back({&list, at});
    };
    for (const model::BoardState state : plan.states) {
        if (plan.query.kind.empty()) add(all_[index_of(state)].list());
        for (const Kind* kind : plan.kinds)
            add(kind->boards[index_of(state)].list());
    }
    while (!sources.empty()) {
        std::uint32_t next = NameTable::kNone;
        for (const Source& source : sources) {
            const std::uint32_t slot = source.list->at(source.at);
            if (next == NameTable::kNone || order_.label(slot) < order_.label(next)) next = slot;
        }
        for (std::size_t i = 0; i < sources.size();) {
            Source& source = sources[i];
            if (source.list->at(source.at) == next) source.list->step(source.at);
            if (source.list->at_end(source.at)) {
                sources.erase(sources.begin() + static_cast<std::ptrdiff_t>(i));
            } else {
                ++i;
            }
        }
        const std::string_view name = board(next).name;
        if (!prefix.empty() && name.substr(0, prefix.size()) != prefix) return;
        if (!visit(next)) return;
    }
}

/// One page of an answer, filled with matches in their order until it is full.
struct Catalogue::Impl::Page {
    const Impl& catalogue;
    const QueryPlan& plan;
    Instant now;
    bus::Answer& answer;
    std::size_t taken = 0;
    std::size_t matches = 0;  ///< of all pages, where every match was looked at
    const Board* last = nullptr;
    const Service* last_service = nullptr;
    std::string last_key{};
    bool more = false;

    /// False: the page was full already, and there is more.
    bool take(const Board& b, const Service* service, std::string key = {}) {
        if (taken == plan.limit) return !(more = true);
        ++taken;
        last = &b;
        last_service = service;
        last_key = std::move(key);
        if (service != nullptr) {
            answer.services.push_back(catalogue.service_item(b, *service));
        } else if (answer.brief) {
            answer.brief->add(catalogue.brief_board(b, now, names_of(b)));
        } else {
            answer.boards.push_back(catalogue.board_item(b, now, plan.query.full));
        }
        return true;
    }

    /// Where the next page begins: behind the last that was taken.
    std::string cursor() const {
        const auto service = last_service != nullptr ? std::string(last_service->name) : std::string();
        return Cursor{last->name, service, last_key}.text();
    }

    /// Boards that are alike share their services, and what is seen of them where nothing is left out.
    std::string_view names_of(const Board& b) {
        if (b.services == named && plan.view == nullptr) return names;
        named = b.services;
        names.clear();
        if (named == nullptr) return names;
        for (const Service& service : named->services) {
            if (!plan.sees(b, service)) continue;
            if (!names.empty()) names += ' ';
            names += service.name;
        }
        return names;
    }

    const ServicesPart* named = nullptr;  // whose names are `names`
    std::string names{};
};

namespace {

std::vector<const Service*> matching_services(const QueryPlan& plan, const Board& b) {
    std::vector<const Service*> matching;
    if (b.services == nullptr) return matching;
    for (std::size_t i = 0; i < b.services->services.size(); ++i) {
        if (plan.service_matches(b, *b.services, i)) matching.push_back(&b.services->services[i]);
    }
    return matching;
}

// Orders by other members than the name compare texts.
std::string sort_key(const Board& b, QueryPlan::Sort sort) {
    constexpr std::size_t kDigits = 20;
    switch (sort) {
        case QueryPlan::Sort::kState:
            return std::string(model::to_text(b.effective));
        case QueryPlan::Sort::kChip:
            return b.firmware != nullptr ? b.firmware->chip : std::string();
        case QueryPlan::Sort::kSketch:
            return b.firmware != nullptr ? b.firmware->sketch : std::string();
        case QueryPlan::Sort::kLastSeen: {
            const std::string digits = std::to_string(b.last_heard.time_since_epoch().count());
            return std::string(kDigits - std::min(kDigits, digits.size()), '0') + digits;
        }
        default:
            return b.name;
    }
}

struct Match {
    std::string key;
    std::uint32_t slot;
    const Service* service;

    std::string_view service_name() const { return service != nullptr ? service->name : std::string_view(); }
};

}  // namespace

void Catalogue::Impl::fill_by_name(const QueryPlan& plan, Page& page) const {
    visit_candidates(plan, [&](std::uint32_t slot) {
        const Board& b = board(slot);
        if (!plan.board_matches(b)) return true;
        const bool at_cursor = plan.cursor && b.name == plan.cursor->board;
        if (plan.query.find == bus::Find::kBoards) {
            if (at_cursor || (plan.by_service && !plan.some_service_matches(b))) return true;
            return page.take(b, nullptr);
        }
        auto services = matching_services(plan, b);
        std::sort(services.begin(), services.end(), [](auto* x, auto* y) { return x->name < y->name; });
        for (const Service* service : services) {
            if (at_cursor && service->name <= plan.cursor->service) continue;
            if (!page.take(b, service)) return false;
        }
        return true;
    });
}

// These orders have no index: every match is looked at.
void Catalogue::Impl::fill_sorted(const QueryPlan& plan, Page& page) const {
    const auto after_cursor = [&](const Match& match) {
        if (!plan.cursor) return true;
        if (match.key != plan.cursor->key) return (plan.cursor->key < match.key) != plan.descending;
        return std::tuple(std::string_view(board(match.slot).name), match.service_name()) >
               std::tuple(std::string_view(plan.cursor->board), std::string_view(plan.cursor->service));
    };
    std::vector<Match> matches;
    const auto add = [&](const Board& b, std::uint32_t slot, const Service* service) {
        ++page.matches;
        Match match{sort_key(b, plan.sort), slot, service};
        if (after_cursor(match)) matches.push_back(std::move(match));
    };
    visit_candidates(plan, [&](std::uint32_t slot) {
        const Board& b = board(slot);
        if (!plan.board_matches(b)) return true;
        if (plan.query.find == bus::Find::kServices) {
            for (const Service* service : matching_services(plan, b))
                add(b, slot, service);
        } else if (!plan.by_service || plan.some_service_matches(b)) {
            add(b, slot, nullptr);
        }
        return true;
    });
    const auto less = [&](const Match& x, const Match& y) {
        if (x.key != y.key) return (x.key < y.key) != plan.descending;
        if (x.slot != y.slot) return order_.label(x.slot) < order_.label(y.slot);
        return x.service_name() < y.service_name();
    };
    const std::size_t size = std::min(plan.limit, matches.size());
    std::partial_sort(matches.begin(), matches.begin() + static_cast<std::ptrdiff_t>(size), matches.end(),
                      less);
    for (Match& match : matches) {
        if (!page.take(board(match.slot), match.service, std::move(match.key))) break;
    }
}

std::optional<std::size_t> Catalogue::Impl::total_by_index(const QueryPlan& plan) const {
    if (!plan.counted_by_index()) return std::nullopt;
    const bool boards = plan.query.find == bus::Find::kBoards;
    std::size_t total = 0;
    for (const model::BoardState each : plan.states) {
        const std::size_t state = index_of(each);
        if (plan.query.kind.empty()) total += boards ? all_[state].size() : stats_.services[state];
        for (const Kind* kind : plan.kinds)
            total += boards ? kind->boards[state].size() : kind->services[state];
    }
    return total;
}

Expected<bus::Answer> Catalogue::Impl::find(const bus::Query& query, Instant now, const View* view) {
    settle();
    const auto plan = make_query_plan(query, kinds_, view);
    if (!plan) return Unexpected<std::string>(plan.error());
    bus::Answer answer;
    answer.seq = seq_;
    answer.find = query.find;
    if (query.brief && query.find == bus::Find::kBoards)
        answer.brief.emplace().reserve(std::min(plan->limit, names_.size()));
    Page page{*this, *plan, now, answer};
    if (plan->in_order_of_names()) {
        fill_by_name(*plan, page);
        answer.total = total_by_index(*plan);
        if (!answer.total && query.count) {
            bus::Query everything = query;
            everything.sort = "-name";
            everything.cursor.clear();
            everything.limit = 1;
            everything.full = everything.brief = false;
            answer.total = find(everything, now, view).value().total;
        }
    } else {
        fill_sorted(*plan, page);
        answer.total = page.matches;
    }
    if (page.more) answer.cursor = page.cursor();
    return answer;
}

std::vector<std::string> Catalogue::Impl::names(const std::string& pattern, const std::string& after,
                                                std::size_t max) {
    settle();
    bus::Query query;
    query.board = pattern;
    if (!after.empty()) query.cursor = Cursor{after, {}, {}}.text();
    const auto plan = make_query_plan(query, kinds_, nullptr);
    std::vector<std::string> result;
    if (!plan || max == 0) return result;
    visit_candidates(*plan, [&](std::uint32_t slot) {
        if (const auto& name = board(slot).name; name != after) result.push_back(name);
        return result.size() < max;
    });
    return result;
}

}  // namespace asip::catalogue
