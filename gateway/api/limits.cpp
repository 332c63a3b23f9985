// SPDX-License-Identifier: Apache-2.0
#include "gateway/api/limits.hpp"

#include <nlohmann/json.hpp>
#include <utility>

#include "asip/bus/pattern.hpp"
#include "asip/model/json.hpp"
#include "asip/property/property.hpp"

namespace asip::gateway::api {
namespace {

using nlohmann::json;
using namespace nlohmann::literals;

/// Pins belong to the service that sets and reports them.
bool sees_pins(const Rights& rights, std::string_view board) {
    return rights.sees_service(board, "io");
}

void limit_names(const Rights& rights, const std::string& board, json& object) {
    if (object.contains("/names/pins"_json_pointer) && !sees_pins(rights, board))
        object["names"].erase("pins");
    // The id of a property begins with its service.
    for (const auto& pointer : {"/names/services"_json_pointer, "/meanings"_json_pointer}) {
        if (!object.contains(pointer) || !object[pointer].is_object()) continue;
        auto& named = object[pointer];
        for (auto it = named.begin(); it != named.end();)
            it = rights.sees_service(board, property::service_of(it.key())) ? std::next(it) : named.erase(it);
    }
}

// `object`: a board, or a description, as JSON.
void limit_services(const Rights& rights, const std::string& board, json& object) {
    limit_names(rights, board, object);
    if (!sees_pins(rights, board))
        for (const auto* member : {"pins", "pin_modes"})
            object.erase(member);
    const auto services = object.find("services");
    if (services == object.end() || !services->is_array()) return;
    json kept = json::array();
    for (auto& service : *services) {
        const auto name = service.is_object() ? service.value("name", "") : std::string();
        if (rights.sees_service(board, name)) kept.push_back(std::move(service));
    }
    *services = std::move(kept);
}

class LimitedFeed final : public Feed {
  public:
    LimitedFeed(std::unique_ptr<Feed> feed, Rights rights)
        : feed_(std::move(feed)), rights_(std::move(rights)) {
        feed_->wake = [this] { wake(); };
    }
    bool next(StreamEvent& event, const Instant& now) override {
        if (!feed_->next(event, now)) return false;
        auto data = json::parse(event.data, nullptr, false);
        const auto board = data.is_object() ? data.find("board") : data.end();
        if (board == data.end() || !board->is_object()) return true;
        limit_services(rights_, board->value("board", ""), *board);
        event.data = model::dump_json(data);
        return true;
    }
    void tick(const Instant& now) override { feed_->tick(now); }
    bool more() const override { return feed_->more(); }
    std::string_view fault() const override { return feed_->fault(); }

  private:
    std::unique_ptr<Feed> feed_;
    Rights rights_;
};

/// What `wanted` and what may be read have in common; of two patterns what may be read.
std::vector<std::string> readable(const std::vector<std::string>& allowed, const std::string& wanted) {
    if (allowed.empty()) return {wanted};
    const bool pattern = wanted.find_first_of("*?") != std::string::npos;
    std::vector<std::string> names;
    for (const auto& each : allowed) {
        if (pattern && (each.find_first_of("*?") != std::string::npos || bus::matches_pattern(wanted, each)))
            names.push_back(each);
        if (!pattern && bus::matches_pattern(each, wanted)) return {wanted};
    }
    return names;
}

}  // namespace

catalogue::View view_of(const Rights& rights) {
    catalogue::View view{boards_of(rights), {}};
    if (!rights.services.empty() || !rights.dashboard.empty()) {
        view.service = [rights](std::string_view board, std::string_view service) {
            return rights.sees_service(board, service);
        };
    }
    return view;
}

ChangeFeed::Allowed boards_of(const Rights& rights) {
    if (rights.boards.empty() && rights.dashboard.empty()) return {};
    return [rights](std::string_view board) { return rights.sees_board(board); };
}

void limit_to(const Rights& rights, bus::BoardItem& board) {
    if (rights.services.empty()) return;
    std::erase_if(board.services,
                  [&](const auto& each) { return !rights.sees_service(board.board, each.name); });
    std::erase_if(board.labels.services,
                  [&](const auto& each) { return !rights.sees_service(board.board, each.first); });
    if (!sees_pins(rights, board.board)) board.labels.pins.clear();
    if (board.description.empty()) return;
    auto description = json::parse(board.description, nullptr, false);
    if (description.is_object()) limit_services(rights, board.board, description);
    board.description = description.is_object() ? model::dump_json(description) : std::string();
}

std::shared_ptr<const exports::ExportedBoard> seen(const Rights& rights,
                                                   std::shared_ptr<const exports::ExportedBoard> board) {
    if (rights.services.empty() || !board) return board;
    auto limited = std::make_shared<exports::ExportedBoard>(*board);
    std::erase_if(limited->properties,
                  [&](const auto& each) { return !rights.sees_service(board->board, each.service); });
    return limited;
}

void limit_to(const Rights& rights, bus::Answer& answer) {
    for (auto& board : answer.boards)
        limit_to(rights, board);
}

bool sees(const Rights& rights, const bus::HistoryItem& item) {
    if (item.is_command() && !rights.services.empty())
        return !item.service.empty() && rights.sees_service(item.board, item.service);
    return rights.sees_board(item.board);
}

std::unique_ptr<Feed> limited_feed(std::unique_ptr<Feed> feed, const Rights& rights) {
    if (rights.services.empty()) return feed;
    return std::make_unique<LimitedFeed>(std::move(feed), rights);
}

bus::Demander::Want demand_within(const Rights& rights, caller::Caller& caller, const std::string& board,
                                  const std::string& service, double hz, std::size_t& count) {
    auto wants = std::make_shared<std::vector<bus::Demander::Want>>();
    for (const auto& each : readable(rights.boards, board))
        for (const auto& part : readable(rights.services, service))
            wants->push_back(caller.want(each, part, hz));
    count = wants->size();
    return wants;
}

}  // namespace asip::gateway::api
