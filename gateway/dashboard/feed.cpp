// SPDX-License-Identifier: Apache-2.0
#include "gateway/dashboard/feed.hpp"

#include "asip/bus/registry/query.hpp"
#include "asip/model/json.hpp"
#include "asip/property/documents.hpp"
#include "asip/text/wall_time.hpp"

namespace asip::gateway {
namespace {

using nlohmann::json;

std::size_t bytes_of(const StreamEvent& event) {
    return sizeof event + event.data.size();
}

constexpr auto kLookTime = std::chrono::seconds(1);

}  // namespace

Dashboard with_boards(Dashboard dashboard, Mirror& mirror, const Instant& now) {
    std::vector<Widget> tiles;
    for (auto& widget : dashboard.widgets) {
        const auto labels = bus::LabelSelector::parse(widget.labels);
        if (!labels) {  // it has none
            tiles.push_back(std::move(widget));
            continue;
        }
        bus::Query query;
        query.labels = *labels;
        query.limit = Dashboard::kMaxTiles;
        const auto answer = mirror.find(query, now);
        for (std::size_t i = 0; answer && i < answer->boards.size(); ++i) {
            if (tiles.size() >= Dashboard::kMaxTiles) break;
            auto& tile = tiles.emplace_back(widget);
            tile.board = answer->boards[i].board;
            tile.id += "." + tile.board;
            tile.labels.clear();
        }
    }
    dashboard.widgets = std::move(tiles);
    return dashboard;
}

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
    looked_ = now.time;
    auto etag = etag_of(*found);
    auto tiles = with_boards(*found, mirror_, now);
    auto tiles_etag = etag_of(tiles);
    if (shown_ && etag == etag_ && tiles_etag == tiles_etag_) return;
    end();
    shown_ = true;
    gone_told_ = snapshot_over_ = false;
    etag_ = std::move(etag);
    tiles_etag_ = std::move(tiles_etag);
    dashboard_ = std::move(tiles);
    dashboard_.links.clear();
    auto document = to_json(*found);
    document["name"] = options_.name;
    if (!options_.rights.dashboard.empty()) document.erase("by");
    json data{{"dashboard", std::move(document)}, {"etag", etag_}};
    if (etag_ != tiles_etag_) data["tiles"] = to_json(dashboard_)["widgets"];
    put("dashboard", data);
    changes_ = ~std::uint64_t{0};
    show_boards(now);
    add_sources(now);
}

void DashboardFeed::add_sources(const Instant& now) {
    for (const auto& board : dashboard_.boards()) {
        std::set<std::string> ids;
        for (const auto& widget : dashboard_.widgets)
            if (widget.board == board) ids.insert(widget.property);
        auto options = options_.properties(board, ids);
        auto find = options.find;
        auto feed = std::make_unique<PropertyFeed>(mirror_, std::move(options));
        feed->wake = [this] { wake(); };
        if (!feed->fault().empty()) fault_ = feed->fault();
        sources_.push_back({board, std::move(find), std::move(feed)});
        show_properties(sources_.back(), now);
    }
}

void DashboardFeed::show_properties(const Source& source, const Instant& now) {
    const auto seen = source.find(now);
    for (const auto& widget : dashboard_.widgets) {
        if (widget.board != source.board || !seen.board) continue;
        const auto& all = seen.board->properties;
        const auto found = std::find_if(all.begin(), all.end(),
                                        [&](const auto& each) { return each.id == widget.property; });
        put("property",
            {{"id", widget.id},
             {"property", found == all.end() ? json() : property::to_json(*found, property::Members::kAll)}});
        if (widget.kind != Widget::Kind::kPlot || found == all.end()) continue;
        auto points = past_of(mirror_, widget.board, *found, kMaxPast);
        if (!points.empty()) put("past", {{"id", widget.id}, {"points", std::move(points)}});
    }
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

void DashboardFeed::read(Source& source, const StreamEvent& event, const Instant& now) {
    if (event.kind == "snapshot-end") source.ended = true;
    if (event.kind == "properties") show_properties(source, now);
    if (event.kind != "values") return;
    const auto data = json::parse(event.data, nullptr, false);
    for (const auto& widget : dashboard_.widgets) {
        if (widget.board != source.board) continue;
        const auto stands = data["values"].find(widget.property);
        if (stands == data["values"].end()) continue;
        const std::chrono::duration<double> age(stands->value("age", 0.0));
        const auto at = now.wall - std::chrono::duration_cast<text::WallTime::duration>(age);
        // null: the board says that it has none.
        json said{{"id", widget.id}, {"at", text::iso_time(at)}};
        if (stands->contains("value")) said["value"] = (*stands)["value"];
        put("widget", said);
    }
}

// May be called while values call their feeds: nothing begins or ends here.
bool DashboardFeed::next(StreamEvent& event, const Instant& now) {
    if (!fault_.empty()) return false;
    bool all_ended = true;
    for (auto& source : sources_) {
        StreamEvent inner;
        while (out_.empty() && source.feed->next(inner, now))
            read(source, inner, now);
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
    const bool may_differ = etag_ != tiles_etag_ && now.time - looked_ >= kLookTime;
    if (version_ != dashboards_.version() || may_differ) begin(now);
    if (shown_) show_boards(now);
    if (!out_.empty()) wake();
}

}  // namespace asip::gateway
