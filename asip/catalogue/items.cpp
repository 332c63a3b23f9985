// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <nlohmann/json.hpp>

#include "asip/bus/json/json_scanner.hpp"
#include "asip/bus/json/json_text.hpp"
#include "asip/catalogue/catalogue_impl.hpp"

namespace asip::catalogue {
namespace {

text::WallTime wall(Time time, Instant now) {
    return now.wall - std::chrono::duration_cast<std::chrono::milliseconds>(now.time - time);
}

/// Seconds since it was heard; -1: only what the broker retained of it was.
double age_of(const Board& b, Instant now) {
    return b.last_heard == Time{} ? -1 : std::chrono::duration<double>(now.time - b.last_heard).count();
}

constexpr std::size_t kMaxSummaryBytes = 256;  // of each part

std::string unescaped(std::string_view json) {
    const auto value = nlohmann::json::parse(json, nullptr, false);
    return value.is_string() ? value.get<std::string>() : std::string();
}

/// The member of an object, where it is a string: the last of that name.
std::string text_member(std::string_view object, std::string_view name) {
    bus::JsonScanner scanner(object);
    std::string_view key;
    std::string_view value;
    std::string text;
    if (!scanner.enter_object()) return text;
    while (scanner.next_member(key)) {
        const bool plain = scanner.plain_string(value);
        if (!plain && !scanner.value(value)) return {};
        if (key != name) continue;
        text = plain ? std::string(value) : unescaped(value);
    }
    return text.substr(0, kMaxSummaryBytes);
}

std::string summary(std::string_view json, const char* first, const char* second) {
    std::string text = text_member(json, first);
    const std::string more = text_member(json, second);
    if (!text.empty() && !more.empty()) text += ' ';
    return text + more;
}

/// As its parts are known now.
std::string description_of(const Board& b, Instant now) {
    std::string text = "{\"board\":\"" + b.name + "\",\"session\":\"" + b.session +
                       "\",\"seq\":" + std::to_string(b.seq) +
                       ",\"lease\":" + std::to_string(b.lease_seconds);
    const auto member = [&text](std::string_view name, std::string_view value) {
        if (!value.empty()) text.append(",\"").append(name).append("\":").append(value);
    };
    if (b.firmware != nullptr) member("firmware", b.firmware->text);
    member("link", b.link());
    member("agent", b.agent());
    if (b.pins != nullptr) member("pins", b.pins->text);
    if (b.services != nullptr) member("services", b.services->text);
    if (!b.extra().empty()) text.append(",").append(b.extra());
    if (b.says_state) {
        const auto since = b.reported_since == Time{} ? now.time : b.reported_since;
        text.append(R"(,"state":{"is":")").append(model::to_text(b.reported)).append(R"(","reason":")");
        text.append(model::to_text(b.reported_reason)).append(R"(","age":)");
        bus::append_json_seconds(text,
                                 std::max(0.0, std::chrono::duration<double>(now.time - since).count()));
        text += '}';
    }
    text += '}';
    return text;
}

}  // namespace

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
    if (b.labels() != nullptr) item.label = b.labels()->service(item.name);
    return item;
}

bus::BriefBoard Catalogue::Impl::brief_board(const Board& b, Instant now, std::string_view services) const {
    bus::BriefBoard row;
    row.board = b.name;
    row.state = model::to_text(b.effective);
    row.age = age_of(b, now);
    if (b.firmware != nullptr) {
        row.chip = b.firmware->chip;
        row.sketch = b.firmware->shown;
    }
    row.services = services;
    row.conflict = b.conflict() != nullptr;
    row.reason = model::to_text(b.reason);
    if (!row.reason.empty() && b.since != Time{})
        row.state_age = std::chrono::duration<double>(now.time - b.since).count();
    return row;
}

bus::BoardItem Catalogue::Impl::board_item(const Board& b, Instant now, bool full) const {
    bus::BoardItem item;
    item.board = b.name;
    item.state = model::to_text(b.effective);
    if (b.state_said) item.reported = model::to_text(b.reported);
    item.names_only = b.names_only || !b.described;
    item.session = b.session;
    item.seq = b.seq;
    item.lease = b.lease_seconds;
    item.first_seen = wall(b.first_seen, now);
    if (b.since != Time{}) {
        item.since = wall(b.since, now);
        item.state_age = std::max(0.0, std::chrono::duration<double>(now.time - b.since).count());
    }
    if (const auto known = remembered(b.name)) {
        if (known->first_seen) item.first_seen = *known->first_seen;
        // What the agent says of the time counts more, and that it was there behind what was remembered.
        const bool told = (b.says_state && b.since == b.reported_since) || b.deadline == Time{};
        if (known->since && known->state == b.effective && !told) item.since = *known->since;
    }
    item.reason = model::to_text(b.conflict() != nullptr && b.reason == model::StateReason::kNone
                                     ? model::StateReason::kConflict
                                     : b.reason);
    if (b.last_heard != Time{}) item.last_seen = wall(b.last_heard, now);
    item.age = age_of(b, now);
    if (b.firmware != nullptr) {
        item.chip = b.firmware->chip;
        item.sketch = b.firmware->sketch;
        item.version = b.firmware->version;
        item.available = b.firmware->available;
        item.protocol = b.firmware->protocol;
    }
    item.agent = summary(b.agent(), "host", "client");
    item.link = summary(b.link(), "kind", "path");
    if (b.labels() != nullptr) item.labels = *b.labels();
    if (const Challenger* other = b.conflict(); other != nullptr) {
        item.conflict = bus::Conflict{b.session, other->session, summary(other->agent, "host", "client")};
    }
    if (b.services != nullptr) {
        for (const Service& service : b.services->services)
            item.services.push_back(service_item(b, service));
    }
    if (full && b.described) item.description = description_of(b, now);
    return item;
}

}  // namespace asip::catalogue
