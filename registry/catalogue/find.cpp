#include <algorithm>
#include <nlohmann/json.hpp>

#include "asip/bus/pattern.hpp"
#include "asip/text/wall_time.hpp"
#include "registry/catalogue/catalogue_impl.hpp"

namespace asip::registry {
namespace {

using model::BoardState;

constexpr std::array<BoardState, kStates> kAllStates{
    BoardState::Online, BoardState::Offline, BoardState::Lost, BoardState::Sleeping, BoardState::Updating};

unsigned capability_bit(std::string_view word) {
    if (word == "digital") return 1;
    if (word == "analog") return 2;
    if (word == "pwm") return 4;
    return 0;
}

// Where the previous page ended: "BOARD/SERVICE/KEY", names without '/', the key of other sort orders behind.
struct Cursor {
    std::string board, service, key;
};

std::optional<Cursor> read_cursor(std::string_view text) {
    const std::size_t first = text.find('/');
    if (first == std::string_view::npos) return std::nullopt;
    const std::size_t second = text.find('/', first + 1);
    if (second == std::string_view::npos) return std::nullopt;
    return Cursor{std::string(text.substr(0, first)), std::string(text.substr(first + 1, second - first - 1)),
                  std::string(text.substr(second + 1))};
}

std::string_view literal_front(std::string_view pattern) {
    return pattern.substr(0, pattern.find_first_of("*?"));
}

text::WallTime wall(Time time, Instant now) {
    return now.wall - std::chrono::duration_cast<std::chrono::milliseconds>(now.time - time);
}

std::string summary(std::string_view json, const char* first, const char* second) {
    if (json.empty()) return {};
    const auto value = nlohmann::json::parse(json, nullptr, false);
    std::string text;
    for (const char* key : {first, second}) {
        const auto found = value.find(key);
        if (found == value.end() || !found->is_string()) continue;
        if (!text.empty()) text += ' ';
        text += found->get<std::string>().substr(0, 256);
    }
    return text;
}

}  // namespace

/// A query with everything looked up that can be.
struct Catalogue::Impl::Plan {
    const bus::Query& query;
    Instant now;
    std::vector<Kind*> kinds;
    std::vector<BoardState> states;
    unsigned capability = 0;
    std::string sort;
    bool descending = false;
    std::optional<Cursor> cursor;
    std::size_t limit = 0;
    bool by_service = false;  // some filter looks at services, or they are what is asked for

    bool kind_wanted(const Kind* kind) const {
        return query.kind.empty() || std::find(kinds.begin(), kinds.end(), kind) != kinds.end();
    }
    bool board_matches(const Board& b) const {
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
    bool service_matches(const ServicesPart& part, std::size_t i) const {
        const Service& service = part.services[i];
        if (!kind_wanted(service.kind) || !bus::matches_pattern(query.service, service.name)) return false;
        if (query.unit.empty()) return true;
        if (std::find(service.kind->units.begin(), service.kind->units.end(), query.unit) !=
            service.kind->units.end()) {
            return true;
        }
        return std::any_of(part.own_units.begin(), part.own_units.end(),
                           [&](const auto& own) { return own.first == i && own.second == query.unit; });
    }
    bool some_service_matches(const Board& b) const {
        if (b.services == nullptr) return false;
        for (std::size_t i = 0; i < b.services->services.size(); ++i) {
            if (service_matches(*b.services, i)) return true;
        }
        return false;
    }
    // Only filters that the indices answer by themselves: then their sizes are the total.
    bool counted_by_index() const {
        return query.board.empty() && query.service.empty() && query.chip.empty() && query.sketch.empty() &&
               query.unit.empty() && query.capability.empty() &&
               (query.kind.size() <= 1 || query.find == bus::Find::kServices);
    }
};

/// Takes matches in their order until the page is full, and counts on where that is asked for.
struct Catalogue::Impl::Collector {
    const Plan& plan;
    bus::Answer& answer;
    bool count_on = false;
    std::size_t matches = 0;
    std::size_t taken = 0;
    std::string last;
    bool more = false;

    bool full() const { return taken == plan.limit; }
    void take(const Impl& catalogue, const Board& b) {
        if (answer.brief) {
            answer.brief->push_back(catalogue.brief_board(b, plan.now));
        } else {
            answer.boards.push_back(catalogue.board_item(b, plan.now, plan.query.full));
        }
    }
};

// Calls `visit(slot)` for each board of the plan's kinds and states in the order of names, from where `visit`
// began until it returns false. Several sorted sets are read side by side.
template <class Visit>
void Catalogue::Impl::visit_candidates(const Plan& plan, const Visit& visit) const {
    struct Source {
        const SlotList* list;
        SlotList::Position at;
    };
    std::vector<Source> sources;
    const std::string from(std::max(plan.cursor && plan.sort == "name" && !plan.descending
                                        ? std::string_view(plan.cursor->board)
                                        : std::string_view(),
                                    literal_front(plan.query.board)));
    const auto before = [&](std::uint32_t slot) { return board(slot).name < from; };
    const auto add = [&](const SlotList& list) {
        const auto at = from.empty() ? SlotList::Position{} : list.lower_bound(before);
        if (!list.at_end(at)) sources.push_back({&list, at});
    };
    for (const BoardState state : plan.states) {
        if (plan.query.kind.empty()) add(all_[index_of(state)].list());
        for (const Kind* kind : plan.kinds)
            add(kind->boards[index_of(state)].list());
    }
    const std::string_view prefix = literal_front(plan.query.board);
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

void Catalogue::Impl::scan_ordered(const Plan& plan, Collector& out) {
    visit_candidates(plan, [&](std::uint32_t slot) {
        const Board& b = board(slot);
        if (!plan.board_matches(b)) return true;
        const bool at_cursor = plan.cursor && b.name == plan.cursor->board;
        if (plan.query.find == bus::Find::kBoards) {
            if (at_cursor || (plan.by_service && !plan.some_service_matches(b))) return true;
            if (out.full()) return !(out.more = true);
            ++out.taken;
            out.take(*this, b);
            out.last = b.name + "//";
            return true;
        }
        if (b.services == nullptr) return true;
        std::vector<const Service*> matching;
        for (std::size_t i = 0; i < b.services->services.size(); ++i) {
            const Service& service = b.services->services[i];
            if (at_cursor && service.name <= plan.cursor->service) continue;
            if (plan.service_matches(*b.services, i)) matching.push_back(&service);
        }
        std::sort(matching.begin(), matching.end(), [](auto* x, auto* y) { return x->name < y->name; });
        for (const Service* service : matching) {
            if (out.full()) return !(out.more = true);
            ++out.taken;
            out.answer.services.push_back(service_item(b, *service));
            out.last = b.name + "/" + std::string(service->name) + "/";
        }
        return true;
    });
}

// Orders other than by name have no index: every match is looked at.
void Catalogue::Impl::scan_sorted(const Plan& plan, Collector& out) {
    struct Hit {
        std::string key;
        std::uint32_t slot;
        const Service* service;
    };
    const auto key_of = [&](const Board& b) -> std::string {
        if (plan.sort == "state") return std::string(model::to_text(b.effective));
        if (plan.sort == "chip") return b.firmware != nullptr ? b.firmware->chip : "";
        if (plan.sort == "sketch") return b.firmware != nullptr ? b.firmware->sketch : "";
        if (plan.sort == "last_seen") {
            std::string digits = std::to_string(b.last_heard.time_since_epoch().count());
            return std::string(20 - std::min<std::size_t>(20, digits.size()), '0') + digits;
        }
        return b.name;
    };
    const auto name_of = [](const Hit& hit) {
        return hit.service != nullptr ? hit.service->name : std::string_view();
    };
    const auto less = [&](const Hit& x, const Hit& y) {
        if (x.key != y.key) return (x.key < y.key) != plan.descending;
        if (x.slot != y.slot) return order_.label(x.slot) < order_.label(y.slot);
        return name_of(x) < name_of(y);
    };
    const auto after_cursor = [&](const Hit& hit) {
        if (!plan.cursor) return true;
        if (hit.key != plan.cursor->key) return (plan.cursor->key < hit.key) != plan.descending;
        const std::string& name = board(hit.slot).name;
        return name != plan.cursor->board ? name > plan.cursor->board : name_of(hit) > plan.cursor->service;
    };
    std::vector<Hit> hits;
    const auto add = [&](Hit hit) {
        ++out.matches;
        if (after_cursor(hit)) hits.push_back(std::move(hit));
    };
    visit_candidates(plan, [&](std::uint32_t slot) {
        const Board& b = board(slot);
        if (!plan.board_matches(b)) return true;
        if (plan.query.find == bus::Find::kBoards) {
            if (!plan.by_service || plan.some_service_matches(b)) add({key_of(b), slot, nullptr});
        } else if (b.services != nullptr) {
            for (std::size_t i = 0; i < b.services->services.size(); ++i) {
                if (plan.service_matches(*b.services, i)) add({key_of(b), slot, &b.services->services[i]});
            }
        }
        return true;
    });
    const std::size_t page = std::min(plan.limit, hits.size());
    std::partial_sort(hits.begin(), hits.begin() + static_cast<std::ptrdiff_t>(page), hits.end(), less);
    out.more = page < hits.size();
    for (std::size_t i = 0; i < page; ++i) {
        const Board& b = board(hits[i].slot);
        if (hits[i].service != nullptr) {
            out.answer.services.push_back(service_item(b, *hits[i].service));
        } else {
            out.take(*this, b);
        }
        out.last = b.name + "/" + std::string(name_of(hits[i])) + "/" + hits[i].key;
    }
}

Expected<bus::Answer> Catalogue::Impl::find(const bus::Query& query, Instant now) {
    Plan plan{query, now, {}, {}, 0, query.sort, false, {}, 0, false};
    if (query.find == bus::Find::kHistory) return fail("the catalogue keeps no history");
    if (!plan.sort.empty() && plan.sort.front() == '-') {
        plan.descending = true;
        plan.sort.erase(0, 1);
    }
    if (plan.sort.empty()) plan.sort = "name";
    for (const char* known : {"name", "state", "chip", "sketch", "last_seen", ""}) {
        if (*known == '\0')
            return fail("sort: \"" + plan.sort + "\" is none of name, state, chip, sketch, last_seen");
        if (plan.sort == known) break;
    }
    for (const std::string& word : query.state) {
        const auto state = model::board_state_from_text(word);
        if (!state)
            return fail("state: \"" + word + "\" is none of online, offline, lost, sleeping, updating");
        if (std::find(plan.states.begin(), plan.states.end(), *state) == plan.states.end()) {
            plan.states.push_back(*state);
        }
    }
    if (query.state.empty()) plan.states.assign(kAllStates.begin(), kAllStates.end());
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
    settle();
    for (const std::string& name : query.kind) {
        Kind* kind = kinds_.find(name);
        if (kind != nullptr && std::find(plan.kinds.begin(), plan.kinds.end(), kind) == plan.kinds.end()) {
            plan.kinds.push_back(kind);
        }
    }

    bus::Answer answer;
    answer.seq = seq_;
    if (query.brief && query.find == bus::Find::kBoards) answer.brief.emplace();
    Collector out{plan, answer, false, 0, 0, {}, false};
    if (plan.sort == "name" && !plan.descending) {
        scan_ordered(plan, out);
        if (plan.counted_by_index()) {
            std::size_t total = 0;
            for (const BoardState state : plan.states) {
                const std::size_t s = index_of(state);
                if (query.kind.empty())
                    total += query.find == bus::Find::kBoards ? all_[s].size() : stats_.services[s];
                for (const Kind* kind : plan.kinds) {
                    total += query.find == bus::Find::kBoards ? kind->boards[s].size() : kind->services[s];
                }
            }
            answer.total = total;
        } else if (query.count) {
            bus::Query everything = query;
            everything.sort = "-name";
            everything.cursor.clear();
            everything.limit = 1;
            everything.full = everything.brief = false;
            answer.total = find(everything, now).value().total;
        }
    } else {
        scan_sorted(plan, out);
        answer.total = out.matches;
    }
    if (out.more) answer.cursor = out.last;
    return answer;
}

bus::ServiceItem Catalogue::Impl::service_item(const Board& b, const Service& service) const {
    bus::ServiceItem item;
    item.board = b.name;
    item.state = model::to_text(b.effective);
    item.name = service.name;
    item.kind = service.kind->name;
    item.model = service.model;
    if (service.id != 0) item.id = std::string(1, service.id);
    item.title = unescape(service.title);
    if (service.count >= 0) item.count = service.count;
    if (service.period >= 0) item.period = service.period;
    return item;
}

bus::BriefBoard Catalogue::Impl::brief_board(const Board& b, Instant now) const {
    bus::BriefBoard row;
    row.board = b.name;
    row.state = model::to_text(b.effective);
    if (b.last_heard != Time{}) row.age = std::chrono::duration<double>(now.time - b.last_heard).count();
    if (b.firmware != nullptr) {
        row.chip = b.firmware->chip;
        row.sketch = b.firmware->sketch;
    }
    row.conflict = b.conflict() != nullptr;
    if (b.services == nullptr) return row;
    for (const Service& service : b.services->services) {
        if (!row.services.empty()) row.services += ' ';
        row.services += service.name;
    }
    return row;
}

bus::BoardItem Catalogue::Impl::board_item(const Board& b, Instant now, bool full) const {
    bus::BoardItem item;
    item.board = b.name;
    item.state = model::to_text(b.effective);
    item.said = model::to_text(b.said);
    item.by_name = b.by_name || !b.described;
    item.session = b.session;
    item.seq = b.seq;
    item.lease = b.lease_seconds;
    item.first_seen = wall(b.first_seen, now);
    item.since = wall(b.since, now);
    if (b.last_heard != Time{}) {
        item.last_seen = wall(b.last_heard, now);
        item.age = std::chrono::duration<double>(now.time - b.last_heard).count();
    }
    if (b.firmware != nullptr) {
        item.chip = b.firmware->chip;
        item.sketch = b.firmware->sketch;
        item.protocol = b.firmware->protocol;
    }
    item.agent = summary(b.agent(), "host", "client");
    item.link = summary(b.link(), "kind", "path");
    if (const Challenger* other = b.conflict(); other != nullptr) {
        item.conflict = bus::Conflict{b.session, other->session, summary(other->agent, "host", "client")};
    }
    if (b.services != nullptr) {
        for (const Service& service : b.services->services)
            item.services.push_back(service_item(b, service));
    }
    if (full && b.described) {
        std::string& text = item.description;
        text = "{\"board\":\"" + b.name + "\",\"session\":\"" + b.session +
               "\",\"seq\":" + std::to_string(b.seq) + ",\"lease\":" + std::to_string(b.lease_seconds);
        const auto member = [&text](std::string_view name, std::string_view value) {
            if (!value.empty()) text.append(",\"").append(name).append("\":").append(value);
        };
        if (b.firmware != nullptr) member("firmware", b.firmware->text);
        member("link", b.link());
        member("agent", b.agent());
        if (b.pins != nullptr) member("pins", b.pins->text);
        if (b.services != nullptr) member("services", b.services->text);
        if (!b.extra().empty()) text.append(",").append(b.extra());
        text += '}';
    }
    return item;
}

}  // namespace asip::registry
