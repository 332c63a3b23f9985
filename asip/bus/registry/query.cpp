// SPDX-License-Identifier: Apache-2.0
#include "asip/bus/registry/query.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <nlohmann/json.hpp>

#include "asip/bus/registry/members.hpp"
#include "asip/model/json.hpp"
#include "asip/text/json_reader.hpp"

namespace asip::bus {
namespace {

using namespace members;
using nlohmann::json;
using text::JsonReader;

constexpr std::size_t kMaxFilterBytes = 256;
constexpr std::size_t kMaxCursorBytes = 2 * kMaxFilterBytes;  // BOARD/PROPERTY
constexpr std::size_t kMaxChoices = 64;
constexpr std::size_t kUsualPoints = 500;

void read_find(JsonReader& reader, Query& query) {
    const auto word = reader.text("find");
    for (const Find each : {Find::kBoards, Find::kServices, Find::kHistory, Find::kModels, Find::kValues})
        if (word == to_string(each)) return void(query.find = each);
    reader.fault("find", reader.has("find")
                             ? "is not \"boards\", \"services\", \"history\", \"values\" or \"models\""
                             : "is missing; \"boards\", \"services\", \"history\", \"values\" or "
                               "\"models\" (or \"forget\", with a board)");
}

void read_labels(JsonReader& reader, Query& query) {
    const auto text = reader.text("labels", {}, LabelSelector::kMaxBytes);
    if (text.empty()) return;
    auto selector = LabelSelector::parse(text);
    if (!selector) return reader.fault("labels", selector.error());
    query.labels = std::move(*selector);
}

text::WallTime read_time(JsonReader& reader, const char* key) {
    const auto text = reader.text(key, {}, kMaxFilterBytes);
    const auto time = text::parse_iso_time(text);
    if (!time) reader.fault(key, "is not a time such as 2026-11-21T10:00Z");
    return time.value_or(text::WallTime{});
}

void read_values(JsonReader& reader, Query& query) {
    query.board = reader.text("board", {}, kMaxFilterBytes);
    query.property = reader.text("property", {}, kMaxFilterBytes);
    if (query.property.empty()) {
        query.cursor = reader.text("cursor", {}, kMaxCursorBytes);
        if (const auto limit = reader.integer("limit", 1, std::numeric_limits<std::uint64_t>::max()))
            query.limit = static_cast<std::size_t>(std::min<std::uint64_t>(*limit, Query::kMaxPage));
        return;
    }
    query.from = read_time(reader, "from");
    query.to = read_time(reader, "to");
    if (reader.ok() && query.from >= query.to) reader.fault("from", "is not before \"to\"");
    query.limit = static_cast<std::size_t>(
        reader.integer("points", 1, std::numeric_limits<std::uint64_t>::max()).value_or(kUsualPoints));
    query.limit = std::min(query.limit, Query::kMaxPage);
}

Query query_from(JsonReader& reader) {
    Query query;
    read_find(reader, query);
    if (query.find == Find::kValues) {
        read_values(reader, query);
        return query;
    }
    const auto filter = [&](const char* key) { return reader.text(key, {}, kMaxFilterBytes); };
    query.kind = reader.texts("kind", kMaxChoices, kMaxFilterBytes);
    query.cursor = filter("cursor");
    if (const auto limit = reader.integer("limit", 1, std::numeric_limits<std::uint64_t>::max()))
        query.limit = static_cast<std::size_t>(std::min<std::uint64_t>(*limit, Query::kMaxPage));
    if (query.find == Find::kModels) return query;  // the other members are about boards, and refused
    query.board = filter("board");
    query.service = filter("service");
    query.chip = filter("chip");
    query.sketch = filter("sketch");
    query.unit = filter("unit");
    query.capability = filter("capability");
    read_labels(reader, query);
    if (auto sort = filter("sort"); !sort.empty()) query.sort = std::move(sort);
    query.state = reader.texts("state", kMaxChoices, kMaxFilterBytes);
    query.count = reader.flag("count");
    query.full = reader.flag("full");
    query.brief = reader.flag("brief");
    if (query.brief && (query.full || query.find != Find::kBoards))
        reader.fault("brief", "is only for boards, and not together with full");
    return query;
}

Forget forget_from(JsonReader& reader) {
    Forget forget;
    forget.board = reader.text("forget", {}, kMaxFilterBytes);
    if (forget.board.empty()) reader.fault("forget", "does not name a board");
    forget.dry_run = reader.flag("dry_run");
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
    put(object, "labels", query.labels.text());
    if (query.sort != defaults.sort) put(object, "sort", query.sort);
    const bool points = query.find == Find::kValues && !query.property.empty();
    if (query.limit != (points ? kUsualPoints : defaults.limit))
        object[points ? "points" : "limit"] = query.limit;
    put(object, "property", query.property);
    put(object, "from", query.from);
    put(object, "to", query.to);
    put(object, "cursor", query.cursor);
    if (query.count) object["count"] = true;
    if (query.full) object["full"] = true;
    if (query.brief) object["brief"] = true;
    return object;
}

}  // namespace

std::string_view to_string(Find find) {
    static constexpr std::array<std::string_view, 5> kWords{"boards", "services", "history", "models",
                                                            "values"};
    return kWords.at(static_cast<std::size_t>(find));
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
    std::string fault;
    JsonReader reader(object, "", fault, JsonReader::Nulls::kAbsent);
    std::variant<Query, Forget> request;
    if (object.is_object() && object.contains("forget"))
        request = forget_from(reader);
    else
        request = query_from(reader);
    reader.refuse_others();
    if (!reader.ok()) return fail(std::move(fault));
    return request;
}

}  // namespace asip::bus
