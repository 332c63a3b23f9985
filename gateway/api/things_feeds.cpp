// SPDX-License-Identifier: Apache-2.0
#include "gateway/api/things_feeds.hpp"

#include <nlohmann/json.hpp>

#include "asip/bus/registry/board_match.hpp"
#include "asip/model/json.hpp"
#include "gateway/api/things.hpp"

namespace asip::gateway::api {

namespace {

using nlohmann::json;

/// What another feed gives, each message made into another one or left out.
class Translated : public Feed {
  public:
    explicit Translated(std::unique_ptr<Feed> feed) : feed_(std::move(feed)) {
        feed_->wake = [this] { wake(); };
    }
    bool next(StreamEvent& event, const Instant& now) override {
        while (feed_->next(event, now))
            if (translate(event)) return true;
        return false;
    }
    bool more() const override { return feed_->more(); }
    std::string_view fault() const override { return feed_->fault(); }
    void tick(const Instant& now) override { feed_->tick(now); }

  private:
    /// False: nothing becomes of it.
    virtual bool translate(StreamEvent& event) = 0;

    std::unique_ptr<Feed> feed_;
};

class PropertyValues final : public Translated {
  public:
    PropertyValues(std::unique_ptr<Feed> feed, std::string id)
        : Translated(std::move(feed)), id_(std::move(id)) {}

  private:
    bool translate(StreamEvent& event) override {
        if (event.kind != "values") return false;
        const auto document = model::parse_json(event.data);
        const auto pointer = json::json_pointer("/values") / id_ / "value";
        if (!document || !document->contains(pointer) || (*document)[pointer].is_null()) return false;
        auto text = model::dump_json((*document)[pointer]);
        if (text == sent_) return false;
        sent_ = text;
        event = {"message", {}, std::move(text)};
        return true;
    }

    std::string id_, sent_;
};

class ThingsFeed final : public Translated {
  public:
    ThingsFeed(std::unique_ptr<Feed> feed, exports::WebOfThings dialect, std::string only)
        : Translated(std::move(feed)), dialect_(std::move(dialect)), only_(std::move(only)) {}

  private:
    bool translate(StreamEvent& event) override {
        const std::string_view kind = event.kind == "added" ? "thing_created"
                                      : event.kind == "description" || event.kind == "properties"
                                          ? "thing_updated"
                                      : event.kind == "forgotten" ? "thing_deleted"
                                                                  : "";
        if (kind.empty() || (!only_.empty() && only_ != kind)) return false;
        const auto data = json::parse(event.data, nullptr, false);
        const auto board = data.is_object() ? data.find("board") : data.end();
        if (board == data.end() || !board->is_object()) return false;
        event = {kind, std::move(event.place),
                 model::dump_json({{"id", dialect_.thing_id(board->value("board", ""))}})};
        return true;
    }

    exports::WebOfThings dialect_;
    std::string only_;
};

}  // namespace

std::unique_ptr<Feed> property_values(std::unique_ptr<Feed> values, std::string id) {
    return std::make_unique<PropertyValues>(std::move(values), std::move(id));
}

std::unique_ptr<Feed> things_feed(std::unique_ptr<Feed> changes, exports::WebOfThings dialect,
                                  std::string only) {
    return std::make_unique<ThingsFeed>(std::move(changes), std::move(dialect), std::move(only));
}

using exports::ExportedBoard;

std::optional<Things::Found> Things::find(Mirror& mirror, const std::string& name, const Instant& now) {
    bus::Query query;
    query.board = name;
    query.full = true;
    const auto answer = mirror.find(query, now);
    if (!answer || answer->boards.empty()) return std::nullopt;
    const auto& item = answer->boards[0];
    Found found{item.state, item.session, nullptr};
    auto list = mirror.standing().list(name, item.session);
    const auto hash = std::hash<std::string>()(item.description);
    if (const auto known = boards_.find(name); known != boards_.end() && known->second.hash == hash &&
                                               known->second.bytes == item.description.size() &&
                                               known->second.list == list)
        found.board = known->second.board.lock();
    if (found.board) return found;
    auto made = exports::exported_board(item, list.get(), [this](const model::ServiceInfo& service) {
        return bus::model_of(service, models_);
    });
    if (!made) return std::nullopt;
    found.board = std::make_shared<const ExportedBoard>(std::move(*made));
    if (boards_.size() >= tidy_at_) {
        std::erase_if(boards_, [](const auto& each) { return each.second.board.expired(); });
        tidy_at_ = 2 * std::max(kMaxBoards, boards_.size());
    }
    boards_[name] = {hash, item.description.size(), std::move(list), found.board};
    last_.push_back(found.board);
    if (last_.size() > kMaxBoards) last_.pop_front();
    return found;
}

bool Things::want(caller::Caller& caller, const std::string& board, const std::string& service, Time now) {
    std::erase_if(wants_, [&](const auto& each) { return each.second.until <= now; });
    const auto found = wants_.find({board, service});
    const bool is_new = found == wants_.end();
    if (is_new && wants_.size() >= kMaxWants) return true;
    auto& wanted = wants_[{board, service}];
    wanted.until = now + kWantFor;
    if (is_new) wanted.want = caller.want(board, service);
    return is_new;
}

}  // namespace asip::gateway::api
