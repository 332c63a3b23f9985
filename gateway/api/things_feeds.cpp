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

}  // namespace asip::gateway::api
