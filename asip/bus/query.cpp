#include "asip/bus/query.hpp"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>

#include "asip/bus/members.hpp"
#include "asip/model/json.hpp"
#include "asip/text/nearest.hpp"
#include "asip/text/printable.hpp"

namespace asip::bus {
namespace {

using namespace members;
using nlohmann::json;

constexpr std::size_t kMaxFilterBytes = 256;
constexpr std::size_t kMaxChoices = 64;

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

constexpr std::array<std::string_view, 15> kQueryMembers{"find",  "board",  "service",    "kind", "state",
                                                         "chip",  "sketch", "unit",       "sort", "limit",
                                                         "count", "cursor", "capability", "full", "brief"};
constexpr std::array<std::string_view, 2> kForgetMembers{"forget", "dry_run"};

template <class Members>
std::string unknown_member(const json& object, const Members& known) {
    for (const auto& [key, value] : object.items()) {
        if (std::find(known.begin(), known.end(), key) == known.end()) {
            return text::printable(key) + ": no member of this request" + text::did_you_mean(key, known);
        }
    }
    return {};
}

Expected<Query> query_from(const json& object) {
    Query query;
    const auto find = object.find("find");
    if (find == object.end() || !find->is_string()) {
        return fail("find: must be \"boards\", \"services\" or \"history\" (or name a board to \"forget\")");
    }
    bool known = false;
    for (const Find each : {Find::kBoards, Find::kServices, Find::kHistory}) {
        if (find->get_ref<const std::string&>() == to_string(each)) query.find = each, known = true;
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
    if (auto unknown = unknown_member(object, kQueryMembers); !unknown.empty()) return fail(unknown);
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
    if (auto unknown = unknown_member(object, kForgetMembers); !unknown.empty()) return fail(unknown);
    const auto dry_run = flag(object, "dry_run");
    if (!dry_run) return Unexpected<std::string>(dry_run.error());
    forget.dry_run = *dry_run;
    return forget;
}

json to_object(const Query& query) {
    const Query defaults;
    json object{{"find", to_string(query.find)}};
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

}  // namespace

std::string_view to_string(Find find) {
    return find == Find::kBoards ? "boards" : find == Find::kServices ? "services" : "history";
}

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

Expected<std::variant<Query, Forget>> read_registry_request(const json& object) {
    if (!object.is_object()) return fail("not a JSON object");
    if (object.contains("forget")) {
        auto forget = forget_from(object);
        if (!forget) return Unexpected<std::string>(forget.error());
        return std::move(*forget);
    }
    auto query = query_from(object);
    if (!query) return Unexpected<std::string>(query.error());
    return std::move(*query);
}

}  // namespace asip::bus
