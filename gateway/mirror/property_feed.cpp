// SPDX-License-Identifier: Apache-2.0
#include "gateway/mirror/property_feed.hpp"

#include "asip/model/json.hpp"
#include "asip/property/documents.hpp"
#include "asip/property/value.hpp"
#include "asip/text/wall_time.hpp"

namespace asip::gateway {

std::string values_text(Mirror& mirror, const exports::ExportedBoard& board, const std::string& session,
                        const std::function<bool(const property::Property&)>& choose, const Instant& now) {
    property::ValueDocument document;
    document.head = {board.board, session, 0};
    for (const auto& each : board.properties)
        if (each.kind != property::Kind::kButton && choose(each))
            document.values.emplace(each.id,
                                    mirror.shown(board.board, each, now).value_or(property::ShownValue()));
    return property::to_text(document, property::Members::kAll);
}

nlohmann::json past_of(Mirror& mirror, const std::string& board, const property::Property& property,
                       std::size_t max) {
    auto points = nlohmann::json::array();
    const auto* service = property.read ? mirror.values().find(board, property.read->service) : nullptr;
    if (service == nullptr || !exports::is_reported(property)) return points;
    for (auto i = service->points.size(); i > 0 && points.size() < max; --i) {
        const auto& point = service->points[i - 1];
        if (service->channels[point.channel].error || point.cut > 0) continue;
        const auto value = property::value_in(property, nlohmann::json::parse(point.json, nullptr, false));
        if (value && value->is_number()) points.push_back({text::iso_time(point.seen.wall), *value});
    }
    return points;
}

PropertyFeed::PropertyFeed(Mirror& mirror, Options options)
    : mirror_(mirror), options_(std::move(options)), reports_(mirror.values(), std::move(options_.values)) {
    if (!options_.part.set(kBytes)) fault_ = kTooMuchKept;
    reports_.wake = [this] { wake(); };
    told_ = mirror.standing().listen([this](const std::string& board, const Standing::Change& change) {
        if (board != options_.board) return;
        lists_ = lists_ || change.list;
        begins_ = begins_ || change.list || change.anew;
        changed_.insert(change.ids.begin(), change.ids.end());
        for (const auto& [id, act] : change.acts)
            changed_.insert(id);
        wake();
    });
}

/// The ids in a report are enough: the mirror knows how properties stand.
void PropertyFeed::read_report(const StreamEvent& event) {
    if (event.kind == "snapshot-end") live_ = true;
    if (!live_ || event.kind != "value" || !seen_.board) return;
    const auto report = model::parse_json(event.data);
    if (!report || !report->contains("value")) return;
    const auto service = report->value("service", "");
    for (const auto& each : seen_.board->properties)
        if (exports::is_reported(each) && each.read->service == service &&
            property::raw_in(*each.read, (*report)["value"]) != nullptr)
            changed_.insert(each.id);
}

bool PropertyFeed::next(StreamEvent& event, const Instant& now) {
    if (!fault().empty()) return false;
    for (StreamEvent report; reports_.next(report, now);)
        read_report(report);
    if (std::exchange(lists_, false)) {
        event = {"properties", {}, R"({"board":")" + options_.board + "\"}"};
        return true;
    }
    if (std::exchange(begins_, false)) {
        seen_ = options_.find(now);
        changed_.clear();
        if (seen_.board) {
            const auto all = [this](const auto& each) { return is_wanted(each); };
            event = {"values", {}, values_text(mirror_, *seen_.board, seen_.session, all, now)};
            return true;
        }
    }
    if (!std::exchange(ended_, true)) {
        event = {"snapshot-end", {}, "{}"};
        return true;
    }
    if (!seen_.board || changed_.empty()) return false;
    bool any = false;
    const auto choose = [&](const property::Property& each) {
        const bool chosen = is_wanted(each) && changed_.contains(each.id);
        any = any || chosen;
        return chosen;
    };
    auto text = values_text(mirror_, *seen_.board, seen_.session, choose, now);
    changed_.clear();
    if (any) event = {"values", {}, std::move(text)};
    return any;
}

}  // namespace asip::gateway
