// SPDX-License-Identifier: Apache-2.0
#include "cli/ask/board_values.hpp"

#include <utility>

#include "asip/bus/pattern.hpp"
#include "asip/bus/registry/board_match.hpp"
#include "asip/bus/request/reply.hpp"
#include "asip/bus/request/request_envelope.hpp"
#include "asip/model/json.hpp"
#include "asip/property/contact.hpp"
#include "asip/property/list.hpp"
#include "asip/property/value.hpp"

namespace asip::cli {
namespace {

/// Whether the board reports this service by itself now, or as soon as a program demands it.
bool reports(const model::Description& board, const model::ServiceInfo& service) {
    return board.on_demand.has_value() || service.period.value_or(0) > 0;
}

}  // namespace

BoardValues::BoardValues(Environment& environment, BusSession& session, const KnownBoard& board,
                         std::string services)
    : environment_(environment), services_(std::move(services)) {
    if (!board.description) return;
    description_ = *board.description;
    const auto& name = board.item.board;
    const auto& topics = environment.topics;
    reports_ = session.subscribe(topics.service_out(name, "+"),
                                 [this](const mqtt::Message& message) { report(message); });
    demand_ = session.demand(name, services_);
    // A client level of its own: the demand of before stays as it is.
    const auto asker = bus::user_level(environment.mqtt.user) + "/" + environment.mqtt.client_id + "-values";
    bus::Demand question;
    question.asked = {services_};
    question.list = true;
    question_ = session.ask(topics.demand(name, asker), bus::to_text(question),
                            [this](const mqtt::Message& message) { answer(message); });
}

/// The agent answers with its own list: to make one here, all models are read, which takes as long as the
/// answer.
void BoardValues::make_list() {
    if (!std::exchange(listed_, true))
        use(property::properties_of(description_, [&](const model::ServiceInfo& service) {
            return bus::model_of(service, environment_.models());
        }));
}

const std::vector<property::Property>& BoardValues::properties() {
    make_list();
    return properties_;
}

void BoardValues::use(std::vector<property::Property> properties) {
    properties_.clear();
    will_report_.clear();
    for (auto& each : properties) {
        if (!bus::matches_pattern(services_, each.service) || each.kind == property::Kind::kButton) continue;
        const auto* service = description_.service(each.service);
        will_report_.push_back(each.read && !each.floating && service != nullptr &&
                               reports(description_, *service));
        properties_.push_back(std::move(each));
    }
    known_.assign(properties_.size(), {});
}

// The description that is known here may be older than what the agent says.
void BoardValues::answer(const mqtt::Message& message) {
    const auto reply = bus::parse_reply(message.payload);
    if (!reply || !reply->succeeded()) return;
    auto document = property::parse_values(reply->answer);
    if (!document) return;
    answered_ = listed_ = true;
    use(std::move(document->properties));
    const auto now = Clock::now();
    for (std::size_t i = 0; i < properties_.size(); ++i)
        if (const auto found = document->values.find(properties_[i].id); found != document->values.end())
            known_[i] = {found->second, now};
    if (document->pins.is_object()) pins_ = document->pins;
}

void BoardValues::report(const mqtt::Message& message) {
    const auto topic = environment_.topics.parse(message.topic);
    const auto published = model::parse_json(message.payload);
    if (!topic || message.retain || !published || !published->is_object()) return;
    make_list();
    for (std::size_t i = 0; i < properties_.size(); ++i) {
        const auto& property = properties_[i];
        if (!property::is_reported(property) || property.read->service != topic->service) continue;
        if (auto value = property::value_in(property, *published))
            known_[i] = {{std::move(*value), property::How::kReported}, Clock::now()};
    }
}

bool BoardValues::complete() const {
    if (!answered_) return false;
    for (std::size_t i = 0; i < known_.size(); ++i)
        if (will_report_[i] && known_[i].shown.how == property::How::kNone) return false;
    return true;
}

property::ShownValue BoardValues::of(std::size_t property) const {
    auto shown = known_[property].shown;
    const std::chrono::duration<double> since = Clock::now() - known_[property].at;
    if (shown.how != property::How::kNone) shown.age += since.count();
    return shown;
}

std::optional<int> BoardValues::raw_set(std::string_view id) const {
    for (std::size_t i = 0; i < properties_.size(); ++i) {
        const auto& value = known_[i].shown.value;
        if (properties_[i].id != id || known_[i].shown.how == property::How::kNone) continue;
        if (value.is_number()) return value.get<int>();
        for (const auto& [word, number] : properties_[i].choices)
            if (value.is_boolean() && word == (value.get<bool>() ? "on" : "off"))
                return static_cast<int>(number);
        // A dimmed lamp, as a share of its range.
        if (value.is_object() && value.contains("on"))
            return static_cast<int>(value.value("brightness", 0.0) / property::kFullBrightness *
                                    properties_[i].max.value_or(property::kFullBrightness));
    }
    return std::nullopt;
}

std::optional<int> pin_value(const nlohmann::json& pins, const char* event, int key) {
    const auto found = pins.find(event);
    if (found == pins.end() || !found->is_object()) return std::nullopt;
    const auto value = found->find(std::to_string(key));
    if (value == found->end() || !value->is_number_integer()) return std::nullopt;
    return value->get<int>();
}

}  // namespace asip::cli
