// SPDX-License-Identifier: Apache-2.0
#include "tests/truth/values/views.hpp"

#include <variant>

#include "asip/bus/registry/answer.hpp"
#include "asip/bus/registry/board_match.hpp"
#include "asip/model/description.hpp"
#include "asip/property/list.hpp"
#include "asip/property/property_json.hpp"
#include "gateway/export/homie.hpp"

namespace truth::values {

using namespace asip;
using namespace std::chrono_literals;
using gateway::exports::Export;
using gateway::exports::ExportWorld;
using gateway::exports::Sparkplug;
using nlohmann::json;

namespace {

constexpr const char* kBoard = "uno1";
constexpr const char* kAnswers = "answers";
constexpr unsigned kExports = 3;

mqtt::Message message_of(const std::string& topic, const std::string& payload, bool stored) {
    return mqtt::Message{.topic = topic, .payload = payload, .retain = stored};
}

std::shared_ptr<const gateway::exports::Dialect> dialect_of(std::uint64_t seed) {
    switch (seed % kExports) {
        case 0:
            return ExportWorld::home_assistant();
        case 1:
            return std::make_shared<gateway::exports::Homie>(gateway::exports::Homie::Options());
        default:
            return nullptr;
    }
}

struct Shown {
    std::string operator()(std::monostate) const { return {}; }
    std::string operator()(const std::string& text) const { return text; }
    template <class Value>
    std::string operator()(const Value& value) const {
        return json(value).dump();
    }
};

}  // namespace

// --- the gateway

Gateway::Gateway(const Retained& retained) {
    for (const auto& [topic, payload] : retained)
        take(topic, payload, true);
}

void Gateway::take(const std::string& topic, const std::string& payload, bool stored) {
    gateway_->message(message_of(topic, payload, stored));
}

json Gateway::values(const std::string& board) {
    return get("/api/boards/" + board + "/values")->body().value("values", json::object());
}

json Gateway::list() {
    return get("/api/boards/uno1/properties")->body().value("properties", json::array());
}

std::pair<int, std::size_t> Gateway::put(const json& value) {
    published_.clear();
    const int status = ask("PUT", "/api/boards/uno1/values", value.dump())->status();
    return {status, published_.size()};
}

// --- the registry

Registry::Registry(const Retained& retained) {
    registry::RegistryOptions options;
    options.id = "r1";
    registry::Port port;
    port.publish = [this](const mqtt::Message& message) {
        if (message.topic == kAnswers) answer_ = message.payload;
    };
    port.subscribe = [](const std::string&, bool) {};
    port.unsubscribe = [](const std::string&) {};
    registry_.emplace(
        options, model::ModelSet::standard(), [n = 0ull]() mutable { return ++n << 40; }, port, nullptr,
        now());
    registry_->connected(0, now());
    for (const auto& [topic, payload] : retained)
        take(topic, payload, true);
}

void Registry::take(const std::string& topic, const std::string& payload, bool stored) {
    registry_->message(message_of(topic, payload, stored), now());
}

void Registry::pass(std::chrono::milliseconds time) {
    time_ += time;
    registry_->tick(now());
}

json Registry::list() {
    auto query =
        message_of("asip/registry/r1/query", R"({"find":"boards","board":"uno1","full":true})", false);
    query.response_topic = kAnswers;
    answer_.clear();
    registry_->message(query, now());
    registry_->answer_in_turn(now());
    const auto answer = bus::parse_answer(answer_);
    if (!answer || answer->boards.empty()) return {};
    const auto description = model::parse_description(answer->boards.front().description);
    if (!description) return {};
    auto list = json::array();
    const auto models = model::ModelSet::standard();
    for (const auto& each : property::properties_of(
             *description, [&](const model::ServiceInfo& service) { return bus::model_of(service, models); }))
        list.push_back(property::to_json(each, property::Members::kNeeded));
    return list;
}

// --- exports

Exports::Exports(std::uint64_t seed)
    : dialect_(dialect_of(seed)), name_(dialect_ ? dialect_->title() : "Sparkplug"), world_(seed, dialect_) {}

Exports::~Exports() {
    stop();
}

std::unique_ptr<Export> Exports::make(Random random, Port port) {
    wire(port);
    const auto process = "gw" + std::to_string(++started_);
    if (dialect_) {
        auto options = world_.options();
        options.gateway = process;
        return std::make_unique<gateway::exports::Exporter>(options, std::move(random), std::move(port));
    }
    gateway::exports::SparkplugNode::Options options;
    options.dialect.group = "home";
    options.gateway = process;
    options.host = "host";
    return std::make_unique<gateway::exports::SparkplugNode>(options, std::move(random), std::move(port));
}

/// As asip-gateway does.
void Exports::wire(Port& port) {
    port.ready = [this] { return gateway_->mirror().ready(); };
    port.boards = [this] { return gateway_->mirror().board_names(); };
    port.board = [this](const std::string& name) -> std::optional<Export::Present> {
        auto found = gateway_->things().find(gateway_->mirror(), name, gateway_->now());
        if (!found) return std::nullopt;
        return Export::Present{model::takes_commands(found->state), std::move(found->board), found->state,
                               std::move(found->session)};
    };
    port.value = [this](const std::string& board, const Property& property) {
        auto shown = gateway_->mirror().shown(board, property, gateway_->now());
        return shown ? std::optional(std::move(shown->value)) : std::nullopt;
    };
    port.want = [this](const std::string& board, const std::string& service, double hz) {
        return gateway_->caller().want(board, service, hz);
    };
}

void Exports::start(gateway::Gateway& gateway) {
    gateway_ = &gateway;
    seen_ = gateway.mirror().log().last();
    auto& process =
        world_.start([this](Random random, Port port) { return make(std::move(random), std::move(port)); });
    told_ = gateway.mirror().standing().listen([this, &process](const std::string& board,
                                                                const gateway::Standing::Change& change) {
        if (change.anew || !change.ids.empty())
            process.exporter->known(board, change.anew ? std::vector<std::string>() : change.ids, world_.now);
    });
}

void Exports::stop() {
    told_.reset();
    if (!world_.gateways.empty()) world_.kill(*world_.gateways.back());
    world_.gateways.clear();
}

void Exports::ahead(const std::string& topic, const std::string& payload) {
    const auto parsed = bus::Topics().parse(topic);
    if (parsed && parsed->kind == bus::TopicKind::kServiceOut)
        world_.gateways.back()->exporter->value(parsed->board, parsed->service, payload, world_.now);
}

void Exports::behind() {
    for (const auto& log = gateway_->mirror().log(); seen_ < log.last();)
        if (const auto* change = log.change(++seen_); change != nullptr && !change->board.empty())
            world_.gateways.back()->exporter->changed({change->board}, world_.now);
}

void Exports::pass(std::chrono::milliseconds time) {
    behind();
    world_.pass(time);
    if (dialect_)
        world_.sent.clear();
    else
        host_.follow(world_);
}

bool Exports::is_active() const {
    return world_.gateways.back()->exporter->active();
}

const Exports::Property& Exports::property(const std::string& id) {
    static const Property none;
    const auto found = gateway_->things().find(gateway_->mirror(), kBoard, gateway_->now());
    board_ = found ? found->board : nullptr;
    if (board_)
        for (const auto& each : board_->properties)
            if (each.id == id) return each;
    return none;
}

std::string Exports::shown(const std::string& id) {
    if (!dialect_) return std::visit(Shown(), host_.value(kBoard, id));
    const auto found = world_.retained.find(dialect_->state(kBoard, property(id)));
    return found == world_.retained.end() ? text_of(id, nullptr) : found->second;
}

std::string Exports::text_of(const std::string& id, const json& value) {
    const auto& of = property(id);
    if (dialect_) return dialect_->state_text(of, value);
    return std::visit(Shown(), Sparkplug::value(of, Sparkplug::slots(of).front(), value));
}

}  // namespace truth::values
