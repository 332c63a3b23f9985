// SPDX-License-Identifier: Apache-2.0
#include "gateway/api/things_feeds.hpp"

#include <nlohmann/json.hpp>

#include "asip/model/json.hpp"

namespace asip::gateway::api {
namespace {

using nlohmann::json;

/// Of another feed what becomes something else.
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

class PropertyFeed final : public Translated {
  public:
    PropertyFeed(std::unique_ptr<Feed> feed, exports::Entity entity)
        : Translated(std::move(feed)), entity_(std::move(entity)) {}

  private:
    bool translate(StreamEvent& event) override {
        const bool set = event.kind == "set";
        if ((!set && event.kind != "value") || entity_.read.has_value() == set) return false;
        const auto data = model::parse_json(event.data);
        if (!data || !data->contains("value") || data->contains("cut")) return false;
        const auto value = set ? value_set(entity_, (*data)["value"]) : value_in(entity_, (*data)["value"]);
        if (!value || value->is_null()) return false;
        auto text = model::dump_json(*value);
        if (text == sent_) return false;
        sent_ = text;
        event = {"message", std::move(event.place), std::move(text)};
        return true;
    }

    exports::Entity entity_;
    std::string sent_;
};

class ThingsFeed final : public Translated {
  public:
    ThingsFeed(std::unique_ptr<Feed> feed, exports::WebOfThings dialect, std::string only)
        : Translated(std::move(feed)), dialect_(std::move(dialect)), only_(std::move(only)) {}

  private:
    bool translate(StreamEvent& event) override {
        const std::string_view kind = event.kind == "added"         ? "thing_created"
                                      : event.kind == "description" ? "thing_updated"
                                      : event.kind == "forgotten"   ? "thing_deleted"
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

std::unique_ptr<Feed> property_feed(std::unique_ptr<Feed> values, exports::Entity entity) {
    return std::make_unique<PropertyFeed>(std::move(values), std::move(entity));
}

std::unique_ptr<Feed> things_feed(std::unique_ptr<Feed> changes, exports::WebOfThings dialect,
                                  std::string only) {
    return std::make_unique<ThingsFeed>(std::move(changes), std::move(dialect), std::move(only));
}

}  // namespace asip::gateway::api
