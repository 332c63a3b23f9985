// SPDX-License-Identifier: Apache-2.0
#include "asip/bus/items.hpp"

#include <nlohmann/json.hpp>

#include "asip/bus/members.hpp"
#include "asip/model/json.hpp"
#include "asip/text/json_reader.hpp"

namespace asip::bus {

using namespace members;
using nlohmann::json;

ServiceItem read_service_item(const json& object) {
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
    item.label = text_of(object, "label");
    if (item.kind.empty()) item.kind = item.name;
    return item;
}

BoardItem read_board_item(const json& object) {
    BoardItem item;
    item.board = text_of(object, "board");
    item.state = text_of(object, "state");
    item.reported = text_of(object, "reported");
    if (item.reported.empty()) item.reported = item.state;
    item.names_only = flag_of(object, "names_only");
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
    std::string ignored;
    text::JsonReader reader(object, "", ignored);
    item.labels = model::read_labels(reader);
    if (const auto found = object.find("conflict"); found != object.end() && found->is_object()) {
        item.conflict =
            Conflict{text_of(*found, "holder"), text_of(*found, "other"), text_of(*found, "other_agent")};
    }
    if (const auto found = object.find("services"); found != object.end() && found->is_array()) {
        for (const json& service : *found) {
            if (!service.is_object()) continue;
            item.services.push_back(read_service_item(service));
            item.services.back().board = item.board;
            item.services.back().state = item.state;
        }
    }
    if (const auto found = object.find("description"); found != object.end())
        item.description = found->dump();
    return item;
}

HistoryItem read_history_item(const json& object) {
    HistoryItem item;
    item.board = text_of(object, "board");
    item.at = time_of(object, "at");
    item.what = text_of(object, "what");
    item.state = text_of(object, "state");
    item.was = text_of(object, "was");
    item.reason = text_of(object, "reason");
    item.by = text_of(object, "by");
    item.service = text_of(object, "service");
    item.request = text_of(object, "request");
    item.status = text_of(object, "status");
    item.count = int_of(object, "count").value_or(0);
    return item;
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
    put(object, "label", item.label);
    return object;
}

json to_json_without_description(const BoardItem& item) {
    json object{{"board", item.board}, {"state", item.state}};
    if (item.reported != item.state) put(object, "reported", item.reported);
    if (item.names_only) object["names_only"] = true;
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
    model::put_labels(object, item.labels);
    if (item.conflict) {
        object["conflict"] = {{"holder", item.conflict->holder}, {"other", item.conflict->other}};
        put(object["conflict"], "other_agent", item.conflict->other_agent);
    }
    json services = json::array();
    for (const ServiceItem& service : item.services)
        services.push_back(to_json(service, false));
    object["services"] = std::move(services);
    return object;
}

json to_json(const BoardItem& item) {
    json object = to_json_without_description(item);
    if (!item.description.empty()) {
        if (auto description =
                model::parse_json(item.description, {.max_bytes = 1u << 20, .max_depth = 40})) {
            object["description"] = std::move(*description);
        }
    }
    return object;
}

json to_json(const HistoryItem& item) {
    json object{{"what", item.what}};
    put(object, "board", item.board);
    put(object, "at", item.at);
    put(object, "state", item.state);
    put(object, "was", item.was);
    put(object, "by", item.by);
    put(object, "service", item.service);
    put(object, "request", item.request);
    put(object, "status", item.status);
    put(object, "reason", item.reason);
    if (item.count > 1) object["count"] = item.count;
    return object;
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

}  // namespace asip::bus
