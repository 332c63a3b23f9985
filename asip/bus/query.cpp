#include "asip/bus/query.hpp"

#include <array>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "asip/model/json.hpp"

namespace asip::bus {
namespace {

using nlohmann::json;

constexpr std::size_t kMaxRequestBytes = 16 * 1024;
constexpr std::size_t kMaxFilterBytes = 256;
constexpr std::size_t kMaxChoices = 64;

constexpr std::array<std::string_view, 7> kEventWords{"added",    "state",     "description", "conflict",
                                                      "resolved", "forgotten", "reset"};

std::string_view word(Find find) {
    return find == Find::kBoards ? "boards" : find == Find::kServices ? "services" : "history";
}

// Lenient readers for what registries write: a member that is missing or of another type is as good as empty.
std::string text_of(const json& object, const char* key) {
    const auto found = object.find(key);
    return found != object.end() && found->is_string() ? found->get<std::string>() : std::string();
}
std::uint64_t number_of(const json& object, const char* key) {
    const auto found = object.find(key);
    return found != object.end() && found->is_number_unsigned() ? found->get<std::uint64_t>() : 0;
}
double real_of(const json& object, const char* key) {
    const auto found = object.find(key);
    return found != object.end() && found->is_number() ? found->get<double>() : 0;
}
bool flag_of(const json& object, const char* key) {
    const auto found = object.find(key);
    return found != object.end() && found->is_boolean() && found->get<bool>();
}
text::WallTime time_of(const json& object, const char* key) {
    return text::parse_iso_time(text_of(object, key)).value_or(text::WallTime{});
}
std::optional<int> int_of(const json& object, const char* key) {
    const auto found = object.find(key);
    if (found == object.end() || !found->is_number_integer()) return std::nullopt;
    const auto value = found->get<std::int64_t>();
    if (value < INT32_MIN || value > INT32_MAX) return std::nullopt;
    return static_cast<int>(value);
}

void put(json& object, const char* key, const std::string& value) {
    if (!value.empty()) object[key] = value;
}
void put(json& object, const char* key, text::WallTime value) {
    if (value != text::WallTime{}) object[key] = text::iso_time(value);
}

// Strict readers for requests: what is there must be right.
Expected<std::string> filter(const json& object, const char* key) {
    const auto found = object.find(key);
    if (found == object.end() || found->is_null()) return std::string();
    if (!found->is_string()) return fail(std::string(key) + ": must be a text");
    auto value = found->get<std::string>();
    if (value.size() > kMaxFilterBytes) return fail(std::string(key) + ": longer than 256 bytes");
    return value;
}

Expected<std::vector<std::string>> choices(const json& object, const char* key) {
    std::vector<std::string> values;
    const auto found = object.find(key);
    if (found == object.end() || found->is_null()) return values;
    const json list = found->is_string() ? json::array({*found}) : *found;
    const auto wrong = fail(std::string(key) + ": must be a text or a list of at most 64 texts");
    if (!list.is_array() || list.size() > kMaxChoices) return wrong;
    for (const json& value : list) {
        if (!value.is_string() || value.get_ref<const std::string&>().size() > kMaxFilterBytes) return wrong;
        values.push_back(value.get<std::string>());
    }
    return values;
}

Expected<bool> flag(const json& object, const char* key) {
    const auto found = object.find(key);
    if (found == object.end() || found->is_null()) return false;
    if (!found->is_boolean()) return fail(std::string(key) + ": must be true or false");
    return found->get<bool>();
}

Expected<Query> query_from(const json& object) {
    Query query;
    const auto find = object.find("find");
    if (find == object.end() || !find->is_string()) {
        return fail("find: must be \"boards\", \"services\" or \"history\" (or name a board to \"forget\")");
    }
    bool known = false;
    for (const Find each : {Find::kBoards, Find::kServices, Find::kHistory}) {
        if (find->get_ref<const std::string&>() == word(each)) query.find = each, known = true;
    }
    if (!known) return fail("find: must be \"boards\", \"services\" or \"history\"");

    const std::array<std::pair<const char*, std::string*>, 8> texts{{{"board", &query.board},
                                                                     {"service", &query.service},
                                                                     {"chip", &query.chip},
                                                                     {"sketch", &query.sketch},
                                                                     {"unit", &query.unit},
                                                                     {"capability", &query.capability},
                                                                     {"sort", &query.sort},
                                                                     {"cursor", &query.cursor}}};
    for (const auto& [key, member] : texts) {
        auto value = filter(object, key);
        if (!value) return Unexpected<std::string>(value.error());
        if (member != &query.sort || !value->empty()) *member = std::move(*value);
    }
    for (const auto& [key, member] : {std::pair{"kind", &query.kind}, std::pair{"state", &query.state}}) {
        auto value = choices(object, key);
        if (!value) return Unexpected<std::string>(value.error());
        *member = std::move(*value);
    }
    for (const auto& [key, member] : {std::pair{"count", &query.count}, std::pair{"full", &query.full},
                                      std::pair{"brief", &query.brief}}) {
        const auto value = flag(object, key);
        if (!value) return Unexpected<std::string>(value.error());
        *member = *value;
    }
    if (const auto limit = object.find("limit"); limit != object.end() && !limit->is_null()) {
        if (!limit->is_number_unsigned() || limit->get<std::uint64_t>() == 0)
            return fail("limit: must be 1 or more");
        query.limit =
            static_cast<std::size_t>(std::min<std::uint64_t>(limit->get<std::uint64_t>(), Query::kMaxPage));
    }
    if (query.brief && (query.full || query.find != Find::kBoards)) {
        return fail("brief: only for boards, and not together with full");
    }
    return query;
}

Expected<Forget> forget_from(const json& object) {
    Forget forget;
    auto board = filter(object, "forget");
    if (!board) return Unexpected<std::string>(board.error());
    if (board->empty()) return fail("forget: must name a board");
    forget.board = std::move(*board);
    const auto dry_run = flag(object, "dry_run");
    if (!dry_run) return Unexpected<std::string>(dry_run.error());
    forget.dry_run = *dry_run;
    return forget;
}

json to_object(const Query& query) {
    const Query defaults;
    json object{{"find", word(query.find)}};
    put(object, "board", query.board);
    put(object, "service", query.service);
    if (!query.kind.empty()) object["kind"] = query.kind;
    if (!query.state.empty()) object["state"] = query.state;
    put(object, "chip", query.chip);
    put(object, "sketch", query.sketch);
    put(object, "unit", query.unit);
    put(object, "capability", query.capability);
    if (query.sort != defaults.sort) put(object, "sort", query.sort);
    if (query.limit != defaults.limit) object["limit"] = query.limit;
    put(object, "cursor", query.cursor);
    if (query.count) object["count"] = true;
    if (query.full) object["full"] = true;
    if (query.brief) object["brief"] = true;
    return object;
}

ServiceItem service_from(const json& object) {
    ServiceItem item;
    item.board = text_of(object, "board");
    item.state = text_of(object, "state");
    item.name = text_of(object, "name");
    item.kind = text_of(object, "kind");
    item.model = text_of(object, "model");
    item.id = text_of(object, "id");
    item.title = text_of(object, "title");
    item.count = int_of(object, "count");
    item.period = int_of(object, "period");
    if (item.kind.empty()) item.kind = item.name;
    return item;
}

BoardItem board_from(const json& object) {
    BoardItem item;
    item.board = text_of(object, "board");
    item.state = text_of(object, "state");
    item.said = text_of(object, "said");
    if (item.said.empty()) item.said = item.state;
    item.by_name = flag_of(object, "by_name");
    item.session = text_of(object, "session");
    item.seq = number_of(object, "seq");
    item.lease = real_of(object, "lease");
    item.age = real_of(object, "age");
    item.first_seen = time_of(object, "first_seen");
    item.last_seen = time_of(object, "last_seen");
    item.since = time_of(object, "since");
    item.chip = text_of(object, "chip");
    item.sketch = text_of(object, "sketch");
    item.protocol = text_of(object, "protocol");
    item.agent = text_of(object, "agent");
    item.link = text_of(object, "link");
    if (const auto found = object.find("conflict"); found != object.end() && found->is_object()) {
        item.conflict =
            Conflict{text_of(*found, "holder"), text_of(*found, "other"), text_of(*found, "other_agent")};
    }
    if (const auto found = object.find("services"); found != object.end() && found->is_array()) {
        for (const json& service : *found) {
            if (!service.is_object()) continue;
            item.services.push_back(service_from(service));
            item.services.back().board = item.board;
            item.services.back().state = item.state;
        }
    }
    if (const auto found = object.find("description"); found != object.end())
        item.description = found->dump();
    return item;
}

HistoryItem history_from(const json& object) {
    return {text_of(object, "board"), time_of(object, "at"),  text_of(object, "what"),
            text_of(object, "state"), text_of(object, "was"), text_of(object, "reason")};
}

Expected<json> object_from(std::string_view payload) {
    auto document = model::parse_json(payload, {.max_bytes = 16u << 20, .max_depth = 40});
    if (!document) return document;
    if (!document->is_object()) return fail("not a JSON object");
    return document;
}

// The rows of a large catalogue are written and read straight from and into text; a JSON tree costs ten times
// as much.
std::string encode_brief(json& envelope, const std::vector<BriefBoard>& boards) {
    envelope["brief"] = true;
    std::string text = model::dump_json(envelope);
    text.pop_back();
    text += ",\"items\":";
    append_brief_rows(text, boards);
    text += '}';
    return text;
}

}  // namespace

std::string encode(const RegistryRequest& request) {
    json object;
    if (const auto* query = std::get_if<Query>(&request.what)) {
        object = to_object(*query);
    } else {
        const auto& forget = std::get<Forget>(request.what);
        object = {{"forget", forget.board}};
        if (forget.dry_run) object["dry_run"] = true;
    }
    put(object, "id", request.id);
    put(object, "reply_to", request.reply_to);
    return model::dump_json(object);
}

Expected<RegistryRequest> parse_registry_request(std::string_view payload) {
    const auto document = model::parse_json(payload, {.max_bytes = kMaxRequestBytes, .max_depth = 4});
    if (!document) return Unexpected<std::string>(document.error());
    if (!document->is_object()) return fail("not a JSON object");
    RegistryRequest request;
    for (const auto& [key, member] :
         {std::pair{"id", &request.id}, std::pair{"reply_to", &request.reply_to}}) {
        auto value = filter(*document, key);
        if (!value) return Unexpected<std::string>(value.error());
        *member = std::move(*value);
    }
    if (document->contains("forget")) {
        auto forget = forget_from(*document);
        if (!forget) return Unexpected<std::string>(forget.error());
        request.what = std::move(*forget);
    } else {
        auto query = query_from(*document);
        if (!query) return Unexpected<std::string>(query.error());
        request.what = std::move(*query);
    }
    return request;
}

json to_json(const ServiceItem& item, bool with_board) {
    json object{{"name", item.name}};
    if (with_board) {
        object["board"] = item.board;
        object["state"] = item.state;
    }
    if (item.kind != item.name) put(object, "kind", item.kind);
    put(object, "model", item.model);
    put(object, "id", item.id);
    put(object, "title", item.title);
    if (item.count) object["count"] = *item.count;
    if (item.period) object["period"] = *item.period;
    return object;
}

json to_json(const BoardItem& item) {
    json object{{"board", item.board}, {"state", item.state}};
    if (item.said != item.state) put(object, "said", item.said);
    if (item.by_name) object["by_name"] = true;
    put(object, "session", item.session);
    if (!item.session.empty()) object["seq"] = item.seq;
    if (item.lease > 0) object["lease"] = static_cast<std::int64_t>(item.lease);
    put(object, "first_seen", item.first_seen);
    put(object, "since", item.since);
    if (item.last_seen != text::WallTime{}) {
        put(object, "last_seen", item.last_seen);
        object["age"] = static_cast<double>(static_cast<std::int64_t>(item.age * 1000)) / 1000;
    }
    put(object, "chip", item.chip);
    put(object, "sketch", item.sketch);
    put(object, "protocol", item.protocol);
    put(object, "agent", item.agent);
    put(object, "link", item.link);
    if (item.conflict) {
        object["conflict"] = {{"holder", item.conflict->holder}, {"other", item.conflict->other}};
        put(object["conflict"], "other_agent", item.conflict->other_agent);
    }
    json services = json::array();
    for (const ServiceItem& service : item.services)
        services.push_back(to_json(service, false));
    object["services"] = std::move(services);
    if (!item.description.empty()) {
        if (auto description =
                model::parse_json(item.description, {.max_bytes = 1u << 20, .max_depth = 40})) {
            object["description"] = std::move(*description);
        }
    }
    return object;
}

json to_json(const HistoryItem& item) {
    json object{{"board", item.board}, {"what", item.what}};
    put(object, "at", item.at);
    put(object, "state", item.state);
    put(object, "was", item.was);
    put(object, "reason", item.reason);
    return object;
}

std::string encode(const Answer& answer) {
    json object;
    put(object, "id", answer.id);
    put(object, "registry", answer.registry);
    if (!answer.refused.empty()) {
        object["refused"] = answer.refused;
        put(object, "error", answer.error);
        return model::dump_json(object);
    }
    put(object, "epoch", answer.epoch);
    object["seq"] = answer.seq;
    if (answer.settling) object["settling"] = true;
    if (answer.total) object["total"] = *answer.total;
    json items = json::array();
    const char* what = "boards";
    if (!answer.services.empty()) what = "services";
    if (!answer.history.empty()) what = "history";
    for (const BoardItem& item : answer.boards)
        items.push_back(to_json(item));
    for (const ServiceItem& item : answer.services)
        items.push_back(to_json(item));
    for (const HistoryItem& item : answer.history)
        items.push_back(to_json(item));
    if (!answer.forgotten.empty()) object["forgotten"] = answer.forgotten;
    object["find"] = what;
    put(object, "cursor", answer.cursor);
    if (answer.brief) return encode_brief(object, *answer.brief);
    object["items"] = std::move(items);
    return model::dump_json(object);
}

BriefBoard brief_of(const BoardItem& board) {
    BriefBoard brief{board.board, board.state, board.age, board.chip, board.sketch, {}, {}};
    brief.conflict = board.conflict.has_value();
    for (const ServiceItem& service : board.services) {
        if (!brief.services.empty()) brief.services += ' ';
        brief.services += service.name;
    }
    return brief;
}

Expected<Answer> parse_answer(std::string_view payload) {
    const auto split = split_brief(payload);
    const auto document = object_from(split ? split->envelope : payload);
    if (!document) return Unexpected<std::string>(document.error());
    const json& object = *document;
    Answer answer;
    answer.id = text_of(object, "id");
    answer.registry = text_of(object, "registry");
    answer.epoch = text_of(object, "epoch");
    answer.seq = number_of(object, "seq");
    answer.settling = flag_of(object, "settling");
    answer.cursor = text_of(object, "cursor");
    answer.refused = text_of(object, "refused");
    answer.error = text_of(object, "error");
    if (object.contains("total")) answer.total = number_of(object, "total");
    if (const auto found = object.find("forgotten"); found != object.end() && found->is_array()) {
        for (const json& name : *found) {
            if (name.is_string()) answer.forgotten.push_back(name.get<std::string>());
        }
    }
    if (split) {
        auto rows = read_brief_rows(split->rows);
        if (!rows) return Unexpected<std::string>(rows.error());
        answer.brief = std::move(*rows);
        return answer;
    }
    const auto items = object.find("items");
    if (items == object.end() || !items->is_array()) {
        if (answer.refused.empty()) return fail("neither items nor a refusal");
        return answer;
    }
    const std::string find = text_of(object, "find");
    for (const json& item : *items) {
        if (!item.is_object()) return fail("items: must be objects");
        if (find == "services") {
            answer.services.push_back(service_from(item));
        } else if (find == "history") {
            answer.history.push_back(history_from(item));
        } else {
            answer.boards.push_back(board_from(item));
        }
    }
    return answer;
}

std::string_view to_string(ChangeEvent::Kind kind) {
    return kEventWords[static_cast<std::size_t>(kind)];
}

std::string encode(const ChangeEvent& event) {
    json object{{"event", to_string(event.kind)}, {"seq", event.seq}};
    put(object, "registry", event.registry);
    put(object, "epoch", event.epoch);
    put(object, "at", event.at);
    put(object, "was", event.was);
    put(object, "reason", event.reason);
    if (event.kind == ChangeEvent::Kind::kForgotten) {
        object["board"] = {{"board", event.board.board}};
    } else if (event.kind != ChangeEvent::Kind::kReset) {
        object["board"] = to_json(event.board);
    }
    return model::dump_json(object);
}

Expected<ChangeEvent> parse_change_event(std::string_view payload) {
    const auto document = object_from(payload);
    if (!document) return Unexpected<std::string>(document.error());
    const json& object = *document;
    ChangeEvent event;
    const std::string name = text_of(object, "event");
    std::size_t kind = 0;
    while (kind < kEventWords.size() && kEventWords[kind] != name)
        ++kind;
    if (kind == kEventWords.size()) return fail("event: \"" + name + "\" is not known");
    event.kind = static_cast<ChangeEvent::Kind>(kind);
    event.seq = number_of(object, "seq");
    event.registry = text_of(object, "registry");
    event.epoch = text_of(object, "epoch");
    event.at = time_of(object, "at");
    event.was = text_of(object, "was");
    event.reason = text_of(object, "reason");
    const auto board = object.find("board");
    if (board != object.end() && board->is_object()) event.board = board_from(*board);
    if (event.kind != ChangeEvent::Kind::kReset && event.board.board.empty()) return fail("board: missing");
    return event;
}

bool matches_pattern(std::string_view pattern, std::string_view text) {
    if (pattern.empty()) return true;
    std::size_t p = 0;
    std::size_t t = 0;
    std::size_t star = std::string_view::npos;  // the last '*' met, and what it was tried to end before
    std::size_t retry = 0;
    while (t < text.size()) {
        if (p < pattern.size() && pattern[p] == '*') {
            star = p++;
            retry = t;
        } else if (p < pattern.size() && (pattern[p] == '?' || pattern[p] == text[t])) {
            ++p;
            ++t;
        } else if (star != std::string_view::npos) {
            p = star + 1;
            t = ++retry;
        } else {
            return false;
        }
    }
    while (p < pattern.size() && pattern[p] == '*')
        ++p;
    return p == pattern.size();
}

}  // namespace asip::bus
