// SPDX-License-Identifier: Apache-2.0
#include "gateway/dashboard/feed.hpp"

#include "asip/model/json.hpp"
#include "asip/text/wall_time.hpp"

namespace asip::gateway {
namespace {

using nlohmann::json;

std::size_t bytes_of(const StreamEvent& event) {
    return sizeof event + event.data.size();
}

bool in(const Widget& widget, std::string_view board, std::string_view service) {
    return widget.board == board && widget.service == service;
}

}  // namespace

DashboardFeed::DashboardFeed(const Dashboards& dashboards, Mirror& mirror, Options options,
                             const Instant& now)
    : dashboards_(dashboards), mirror_(mirror), options_(std::move(options)), part_(options_.part()) {
    if (!part_.set(kBytes)) fault_ = kTooMuchKept;
    begin(now);
}

DashboardFeed::~DashboardFeed() = default;

void DashboardFeed::end() {
    sources_.clear();
    board_texts_.clear();
    out_.clear();
    part_.set(std::min(part_.bytes(), kBytes));
}

// Only an edit of what is shown begins anew: a link that is made changes nothing here.
void DashboardFeed::begin(const Instant& now) {
    version_ = dashboards_.version();
    const auto* found = dashboards_.find(options_.name);
    const bool seen = found != nullptr && found->seen_by(options_.rights, options_.name);
    if (!seen) {
        if (!dashboards_.known()) return;
        end();
        shown_ = false;
        etag_.clear();
        if (!std::exchange(gone_told_, true)) put("gone", json::object());
        return;
    }
    auto etag = etag_of(*found);
    if (shown_ && etag == etag_) return;
    end();
    shown_ = true;
    gone_told_ = snapshot_over_ = false;
    etag_ = std::move(etag);
    dashboard_ = *found;
    dashboard_.links.clear();
    auto document = to_json(dashboard_);
    document["name"] = options_.name;
    if (!options_.rights.dashboard.empty()) document.erase("by");
    put("dashboard", {{"dashboard", std::move(document)}, {"etag", etag_}});
    changes_ = ~std::uint64_t{0};
    show_boards(now);
    for (const auto& widget : dashboard_.widgets)
        if (widget.kind == Widget::Kind::kPlot) add_past(widget);
    add_sources();
}

void DashboardFeed::add_sources() {
    for (const auto& widget : dashboard_.widgets) {
        if (widget.board.empty()) continue;
        const auto known = [&](const Source& each) { return in(widget, each.board, each.service); };
        if (std::any_of(sources_.begin(), sources_.end(), known)) continue;
        ValueFeed::Options options;
        options.board = widget.board;
        options.service = widget.service;
        options.max_hz = options_.max_hz;
        options.demand = options_.demand(widget.board, widget.service);
        options.part = options_.part();
        auto feed = std::make_unique<ValueFeed>(mirror_.values(), std::move(options));
        feed->wake = [this] { wake(); };
        if (!feed->fault().empty()) fault_ = feed->fault();
        sources_.push_back({widget.board, widget.service, std::move(feed)});
    }
}

void DashboardFeed::add_past(const Widget& widget) {
    const auto* service = mirror_.values().find(widget.board, widget.service);
    if (service == nullptr) return;
    json points = json::array();
    for (auto i = service->points.size(); i > 0 && points.size() < kMaxPast; --i) {
        const auto& point = service->points[i - 1];
        const auto& channel = service->channels[point.channel];
        if (channel.error || channel.set || point.cut > 0) continue;
        const auto value = widget.read_report(json::parse(point.json, nullptr, false));
        if (value && value->is_number()) points.push_back({text::iso_time(point.seen.wall), *value});
    }
    if (!points.empty()) put("past", {{"id", widget.id}, {"points", std::move(points)}});
}

void DashboardFeed::show_boards(const Instant& now) {
    if (changes_ == mirror_.log().last()) return;
    changes_ = mirror_.log().last();
    for (const auto& name : dashboard_.boards()) {
        json data{{"board", name}, {"state", "unknown"}};
        if (const auto board = mirror_.known(name, now)) {
            data["state"] = board->state;
            if (!board->reason.empty()) data["reason"] = board->reason;
            if (const auto called = board->labels.labels.find("name"); called != board->labels.labels.end())
                data["label"] = called->second;
        }
        auto& told = board_texts_[name];
        auto text = model::dump_json(data);
        if (told == text) continue;
        told = std::move(text);
        put("board", data);
    }
}

void DashboardFeed::put(std::string_view kind, const json& data) {
    StreamEvent event{kind, {}, model::dump_json(data)};
    if (!part_.add(bytes_of(event))) {
        fault_ = kTooMuchKept;
        return;
    }
    out_.push_back(std::move(event));
}

void DashboardFeed::read(Source& source, const StreamEvent& event) {
    if (event.kind == "snapshot-end") source.ended = true;
    if (event.kind != "value" && event.kind != "set") return;
    const auto data = json::parse(event.data, nullptr, false);
    if (!data.is_object() || data.contains("cut")) return;
    const auto value = data.find("value");
    if (value == data.end()) return;
    const bool set = event.kind == "set";
    for (const auto& widget : dashboard_.widgets) {
        if (!in(widget, source.board, source.service) || widget.reads_event() == set) continue;
        const auto shown = set ? std::optional(widget.read_set(*value)) : widget.read_report(*value);
        if (!shown) continue;
        json told{{"id", widget.id}, {"value", *shown}, {"at", data.value("at", "")}};
        if (const auto age = data.find("age"); age != data.end()) told["age"] = *age;
        put("widget", told);
    }
}

// May be called while values call their feeds: nothing begins or ends here.
bool DashboardFeed::next(StreamEvent& event, const Instant& now) {
    if (!fault_.empty()) return false;
    bool all_ended = true;
    for (auto& source : sources_) {
        StreamEvent inner;
        while (out_.empty() && source.feed->next(inner, now))
            read(source, inner);
        all_ended = all_ended && source.ended;
        if (!source.feed->fault().empty()) fault_ = source.feed->fault();
    }
    if (out_.empty() && shown_ && all_ended && !std::exchange(snapshot_over_, true))
        put("snapshot-end", json::object());
    if (out_.empty()) return false;
    event = std::move(out_.front());
    out_.pop_front();
    part_.give_back(std::min(part_.bytes(), bytes_of(event)));
    return true;
}

void DashboardFeed::tick(const Instant& now) {
    if (!fault_.empty()) return;
    for (auto& source : sources_)
        source.feed->tick(now);
    if (version_ != dashboards_.version()) begin(now);
    if (shown_) show_boards(now);
    if (!out_.empty()) wake();
}

}  // namespace asip::gateway
