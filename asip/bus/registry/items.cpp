// SPDX-License-Identifier: Apache-2.0
#include "asip/bus/registry/items.hpp"

#include <algorithm>
#include <charconv>
#include <nlohmann/json.hpp>

#include "asip/bus/json/json_scanner.hpp"
#include "asip/bus/json/json_text.hpp"
#include "asip/bus/registry/members.hpp"
#include "asip/model/json.hpp"
#include "asip/text/json_reader.hpp"

namespace asip::bus {

using namespace members;
using nlohmann::json;

namespace {

/// The members of an object become text, in the order in which they are written.
class TextMembers {
  public:
    explicit TextMembers(std::string& out) : out_(out) { out_ += '{'; }
    ~TextMembers() { out_ += '}'; }
    TextMembers(const TextMembers&) = delete;
    TextMembers& operator=(const TextMembers&) = delete;

    void text(const char* key, const std::string& value) {
        if (!value.empty()) append_json_text(member(key), value);
    }
    void time(const char* key, text::WallTime value) {
        if (value != text::WallTime{}) append_json_text(member(key), text::iso_time(value));
    }
    void needed(const char* key, const std::string& value) { append_json_text(member(key), value); }
    template <class Number>
    void number(const char* key, Number value) {
        char digits[24];
        const auto end = std::to_chars(digits, digits + sizeof digits, value);
        member(key).append(digits, end.ptr);
    }
    void seconds(const char* key, double value) { append_json_seconds(member(key), value); }
    void yes(const char* key) { member(key) += "true"; }
    void labels(const model::Labels& labels) { put_tree("labels", labels); }
    void names(const model::Labels& labels) { put_tree("names", labels); }
    template <class Write>
    void object(const char* key, Write write) {
        TextMembers inside(member(key));
        write(inside);
    }
    template <class Item, class Write>
    void array(const char* key, const std::vector<Item>& items, Write write) {
        member(key) += '[';
        for (const Item& item : items) {
            if (&item != &items.front()) out_ += ',';
            TextMembers inside(out_);
            write(inside, item);
        }
        out_ += ']';
    }

  private:
    std::string& member(const char* key) {
        if (out_.back() != '{') out_ += ',';
        return out_.append(1, '"').append(key).append("\":");
    }
    void put_tree(const char* key, const model::Labels& labels) {
        if (labels.empty()) return;
        json object = json::object();
        model::put_labels(object, labels);
        if (object.contains(key)) member(key) += model::dump_json(object[key]);
    }
    std::string& out_;
};

// Members are written in the order of their names, as those of a tree are.
void write(TextMembers& members, const ServiceItem& item, bool with_board) {
    if (with_board) members.needed("board", item.board);
    if (item.count) members.number("count", *item.count);
    members.text("id", item.id);
    if (item.kind != item.name) members.text("kind", item.kind);
    members.text("label", item.label);
    members.text("model", item.model);
    members.needed("name", item.name);
    if (item.period) members.number("period", *item.period);
    if (with_board) members.needed("state", item.state);
    members.text("title", item.title);
}

void write(TextMembers& members, const BoardItem& item) {
    const bool heard = item.last_seen != text::WallTime{};
    if (heard) members.seconds("age", item.age);
    members.text("agent", item.agent);
    members.text("available", item.available);
    members.needed("board", item.board);
    members.text("chip", item.chip);
    if (item.conflict) {
        members.object("conflict", [&item](TextMembers& conflict) {
            conflict.needed("holder", item.conflict->holder);
            conflict.needed("other", item.conflict->other);
            conflict.text("other_agent", item.conflict->other_agent);
        });
    }
    members.time("first_seen", item.first_seen);
    members.labels(item.labels);
    members.time("last_seen", item.last_seen);
    if (item.lease > 0) members.number("lease", static_cast<std::int64_t>(item.lease));
    members.text("link", item.link);
    members.names(item.labels);
    if (item.names_only) members.yes("names_only");
    members.text("protocol", item.protocol);
    members.text("reason", item.reason);
    if (item.reported != item.state) members.text("reported", item.reported);
    if (!item.session.empty()) members.number("seq", item.seq);
    members.array("services", item.services,
                  [](TextMembers& service, const ServiceItem& each) { write(service, each, false); });
    members.text("session", item.session);
    members.time("since", item.since);
    members.text("sketch", item.sketch);
    members.needed("state", item.state);
    if (item.state_age >= 0) members.seconds("state_age", item.state_age);
    members.text("version", item.version);
}

void write(TextMembers& members, const HistoryItem& item) {
    members.time("at", item.at);
    members.text("board", item.board);
    members.text("by", item.by);
    if (item.count > 1) members.number("count", item.count);
    members.text("reason", item.reason);
    members.text("request", item.request);
    members.text("service", item.service);
    members.text("state", item.state);
    members.text("status", item.status);
    members.text("was", item.was);
    members.needed("what", item.what);
}

}  // namespace

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
    item.reason = text_of(object, "reason");
    item.names_only = flag_of(object, "names_only");
    item.session = text_of(object, "session");
    item.seq = number_of(object, "seq");
    item.lease = seconds_of(object, "lease");
    item.age = object.contains("age") ? seconds_of(object, "age") : -1;
    item.first_seen = time_of(object, "first_seen");
    item.last_seen = time_of(object, "last_seen");
    item.since = time_of(object, "since");
    item.state_age = object.contains("state_age") ? seconds_of(object, "state_age") : -1;
    item.chip = text_of(object, "chip");
    item.sketch = text_of(object, "sketch");
    item.version = text_of(object, "version");
    item.available = text_of(object, "available");
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

namespace {

template <class Item>
json tree_of(const Item& item) {
    std::string text;
    append_json(text, item);
    return json::parse(text);
}

}  // namespace

void append_json(std::string& out, const ServiceItem& item) {
    TextMembers members(out);
    write(members, item, true);
}

/// A description is JSON already, and most of a full answer: where it is well-formed, it is not taken apart.
void append_json(std::string& out, const BoardItem& item) {
    JsonScanner scanner(item.description);
    std::string_view whole;
    const bool as_it_is = !item.description.empty() && item.description.front() == '{' &&
                          scanner.value(whole) && whole.size() == item.description.size();
    if (!as_it_is && !item.description.empty()) {
        out += model::dump_json(to_json(item));
        return;
    }
    {
        TextMembers members(out);
        write(members, item);
    }
    if (!as_it_is) return;
    out.back() = ',';
    out.append("\"description\":").append(item.description).append(1, '}');
}

void append_json(std::string& out, const HistoryItem& item) {
    TextMembers members(out);
    write(members, item);
}

json to_json(const ServiceItem& item) {
    return tree_of(item);
}

json to_json(const BoardItem& item) {
    std::string text;
    {
        TextMembers members(text);
        write(members, item);
    }
    auto object = json::parse(text);
    if (item.description.empty()) return object;
    if (auto description = model::parse_json(item.description, {.max_bytes = 1u << 20, .max_depth = 40}))
        object["description"] = std::move(*description);
    return object;
}

json to_json(const HistoryItem& item) {
    return tree_of(item);
}

std::string firmware_text(const std::string& sketch, const std::string& version,
                          const std::string& available) {
    return sketch + (version.empty() ? "" : " " + version) + (available.empty() ? "" : ", out of date");
}

BriefRows brief_of(std::span<const BoardItem> boards) {
    BriefRows rows;
    rows.reserve(boards.size());
    std::string services;
    for (const BoardItem& board : boards) {
        services.clear();
        for (const ServiceItem& service : board.services) {
            if (!services.empty()) services += ' ';
            services += service.name;
        }
        const auto firmware = firmware_text(board.sketch, board.version, board.available);
        rows.add({board.board, board.state, board.age, board.chip, firmware, services,
                  board.conflict.has_value(), board.reason, board.reason.empty() ? -1 : board.state_age});
    }
    return rows;
}

void append_json(std::string& out, const ValuePoint& point) {
    out.append("[\"").append(text::iso_time(point.at)).append("\",");
    if (!point.known) {
        out += "null]";
        return;
    }
    out += json(point.mean).dump();
    if (point.min != point.max)
        out.append(",").append(json(point.min).dump()).append(",").append(json(point.max).dump());
    out += ']';
}

void append_json(std::string& out, const KeptProperty& item) {
    out += json{{"board", item.board}, {"property", item.property}}.dump();
}

std::optional<ValuePoint> read_value_point(const json& array) {
    const auto size = array.size();
    if (!array.is_array() || (size != 2 && size != 4) || !array[0].is_string()) return std::nullopt;
    const auto at = text::parse_iso_time(array[0].get_ref<const std::string&>());
    if (!at) return std::nullopt;
    ValuePoint point{*at};
    if (size == 2 && array[1].is_null()) return point;
    if (!std::all_of(array.begin() + 1, array.end(), [](const json& each) { return each.is_number(); }))
        return std::nullopt;
    point.known = true;
    point.mean = array[1].get<double>();
    point.min = size == 4 ? array[2].get<double>() : point.mean;
    point.max = size == 4 ? array[3].get<double>() : point.mean;
    return point;
}

KeptProperty read_kept_property(const json& object) {
    return {text_of(object, "board"), text_of(object, "property")};
}

}  // namespace asip::bus
