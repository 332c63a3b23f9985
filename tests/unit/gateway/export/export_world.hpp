// SPDX-License-Identifier: Apache-2.0
// A broker, gateways that export, and what Home Assistant makes of it, in simulated time.
#pragma once
#include <algorithm>
#include <deque>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "gateway/export/exporter.hpp"
#include "gateway/export/home_assistant.hpp"

namespace asip::gateway::exports {

using namespace std::chrono_literals;

inline bool topic_matches(std::string_view filter, std::string_view topic) {
    while (true) {
        if (filter == "#") return true;
        const auto f = filter.find('/'), t = topic.find('/');
        const auto level = filter.substr(0, f);
        if (level != "+" && level != topic.substr(0, t)) return false;
        if ((f == std::string_view::npos) || (t == std::string_view::npos))
            return f == t || (t == std::string_view::npos && filter.substr(f + 1) == "#");
        filter.remove_prefix(f + 1);
        topic.remove_prefix(t + 1);
    }
}

class ExportWorld {
  public:
    struct Board {
        bool there = true;
        ExportedBoard board;
        std::string session;
        std::map<std::string, std::string> values;    // by service: JSON
        std::map<std::string, nlohmann::json> known;  // by id: what was set
    };
    struct Sent {
        Time at;
        std::string topic, payload;
    };

    /// One gateway; a process that can be killed.
    struct Gateway {
        std::unique_ptr<Export> exporter;
        bool alive = true, own = false, own_up = false, own_granted = false;
        bool again = false;                 // it asked for a turn
        std::optional<mqtt::Message> will;  // of its own connection
        std::set<std::string> own_filters;
        std::deque<mqtt::Message> inbox, own_inbox;
        std::size_t room = 1000000;
        std::vector<std::string> log;
        std::vector<std::pair<std::string, Request>> commands;
        std::vector<std::function<void(std::string)>> answers;
    };

    explicit ExportWorld(std::uint64_t seed = 1, std::shared_ptr<const Dialect> dialect = nullptr)
        : seed_(seed), dialect_(dialect ? std::move(dialect) : home_assistant()) {}

    static std::shared_ptr<const Dialect> home_assistant(const std::string& prefix = "homeassistant",
                                                         bool read_only = false) {
        HomeAssistant::Options options;
        options.prefix = prefix;
        options.read_only = read_only;
        return std::make_shared<HomeAssistant>(std::move(options));
    }

    Exporter::Options options() const {
        Exporter::Options options;
        options.host = "host";
        options.dialect = dialect_;
        return options;
    }

    Gateway& start(Exporter::Options options) {
        options.gateway = "gw" + std::to_string(gateways.size() + 1);
        return start([options](Random random, Export::Port port) {
            return std::make_unique<Exporter>(options, std::move(random), std::move(port));
        });
    }
    Gateway& start(const MakeExport& make) {
        auto made = std::make_unique<Gateway>();
        auto* gateway = made.get();
        gateways.push_back(std::move(made));
        gateway->exporter = make(random(), port(gateway));
        gateway->exporter->subscribed(now);
        for (const auto& filter : gateway->exporter->subscriptions())
            replay(filter, gateway->inbox);
        return *gateway;
    }
    Gateway& start() { return start(options()); }

    void kill(Gateway& gateway) {
        if (!gateway.alive) return;
        gateway.alive = false;
        if (gateway.own && gateway.will) publish(*gateway.will);
        gateway.own = false;
    }
    void end(Gateway& gateway) {
        gateway.exporter->leave();
        gateway.own = gateway.alive = false;
    }
    void restart_broker(bool keeps) {
        if (!keeps) retained.clear();
        for (auto& gateway : gateways) {
            if (!gateway->alive) continue;
            gateway->exporter->disconnected();
            if (gateway->own) gateway->exporter->own_disconnected();
            gateway->inbox.clear();
            gateway->own_inbox.clear();
            gateway->own_granted = gateway->own_up = false;
            gateway->will = gateway->exporter->will();
            gateway->exporter->subscribed(now);
            for (const auto& filter : gateway->exporter->subscriptions())
                replay(filter, gateway->inbox);
        }
    }

    void publish(const mqtt::Message& message, const Gateway* from = nullptr) {
        sent.push_back({now, message.topic, message.payload});
        if (message.retain) {
            if (message.payload.empty())
                retained.erase(message.topic);
            else
                retained[message.topic] = message.payload;
        }
        auto live = message;
        live.retain = false;
        for (auto& gateway : gateways) {
            if (!gateway->alive) continue;
            for (const auto& filter : gateway->exporter->subscriptions())
                if (topic_matches(filter, live.topic)) gateway->inbox.push_back(live);
            if (gateway->own && (echoes || gateway.get() != from) &&
                std::any_of(gateway->own_filters.begin(), gateway->own_filters.end(),
                            [&](const auto& f) { return topic_matches(f, live.topic); }))
                gateway->own_inbox.push_back(live);
        }
        home_assistant_reads(live);
    }
    void publish(const std::string& topic, const std::string& payload, bool retain = false) {
        publish(mqtt::Message{.topic = topic, .payload = payload, .retain = retain});
    }

    /// Messages are delivered, then a tenth of a second passes.
    void step() {
        deliver();
        now += 100ms;
        for (auto& gateway : gateways) {
            if (!gateway->alive) continue;
            gateway->room = room;
            if (gateway->own && !std::exchange(gateway->own_up, true)) gateway->exporter->own_connected();
            if (gateway->own && !gateway->own_granted) {
                gateway->own_granted = true;
                gateway->exporter->own_subscribed(now);
            }
            turn([&] { gateway->exporter->tick(now); });
            turn([&] { gateway->exporter->sent(now); });
        }
        deliver();
    }
    void pass(Duration time) {
        for (const auto until = now + time; now < until;)
            step();
    }

    void put(const std::string& name, ExportedBoard board) {
        board.board = name;
        if (!boards.contains(name)) boards[name].session = std::to_string(++sessions_);
        boards[name].board = std::move(board);
        changed(name);
    }
    void forget(const std::string& name) {
        boards.erase(name);
        changed(name);
    }
    void changed(const std::string& name) { changed(std::set<std::string>{name}); }
    void changed(const std::set<std::string>& names) {
        for (auto& gateway : gateways)
            if (gateway->alive) turn([&] { gateway->exporter->changed(names, now); });
    }
    void value(const std::string& board, const std::string& service, const std::string& json) {
        boards[board].values[service] = json;
        for (auto& gateway : gateways)
            if (gateway->alive) gateway->exporter->value(board, service, json, now);
        deliver();
    }
    /// What the board's agent says of a property.
    void known(const std::string& board, const std::string& id, const std::optional<nlohmann::json>& value) {
        boards[board].known.erase(id);
        if (value) boards[board].known[id] = *value;
        for (auto& gateway : gateways)
            if (gateway->alive) gateway->exporter->known(board, {id}, now);
        deliver();
    }
    std::size_t times_sent(const std::string& topic) const {
        return static_cast<std::size_t>(
            std::count_if(sent.begin(), sent.end(), [&](const auto& each) { return each.topic == topic; }));
    }

    /// Home Assistant, as far as properties go: what a document leaves out stays.
    void restart_home_assistant() {
        devices.clear();
        for (const auto& [topic, payload] : retained)
            home_assistant_reads(mqtt::Message{.topic = topic, .payload = payload});
        if (!dialect_->status().empty()) publish(dialect_->status(), "online");
    }

    std::map<std::string, std::string> retained;
    std::map<std::string, std::set<std::string>> devices;  // topic of the document -> "platform component"
    std::map<std::string, Board> boards;
    std::vector<std::unique_ptr<Gateway>> gateways;
    std::vector<Sent> sent;
    std::size_t room = 1000000;  // messages a tenth of a second
    Time now{};
    std::uint64_t refused = 0;
    std::size_t looks = 0, most_looks = 0;  // at boards in a turn
    bool echoes = true;                     // as MQTT 3.1.1: a gateway hears what it publishes itself
    std::function<void()> between_turns;    // of a gateway that asked for another one

  private:
    void turn(const std::function<void()>& what) {
        looks = 0;
        what();
        most_looks = std::max(most_looks, looks);
    }
    Random random() {
        return [state = seed_ += 7]() mutable {
            state += 0x9e3779b97f4a7c15;
            auto z = state;
            z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9;
            z = (z ^ z >> 27) * 0x94d049bb133111eb;
            return z ^ z >> 31;
        };
    }

    void replay(const std::string& filter, std::deque<mqtt::Message>& inbox) {
        for (const auto& [topic, payload] : retained) {
            if (!topic_matches(filter, topic)) continue;
            mqtt::Message message{.topic = topic, .payload = payload, .retain = true};
            inbox.push_back(message);
        }
    }

    void deliver() {
        for (bool any = true; any;) {
            any = false;
            for (std::size_t i = 0; i < gateways.size(); ++i) {
                auto& gateway = *gateways[i];
                while (gateway.alive && !gateway.inbox.empty()) {
                    const auto message = gateway.inbox.front();
                    gateway.inbox.pop_front();
                    gateway.exporter->message(message, now);
                    any = true;
                }
                while (gateway.alive && gateway.own && !gateway.own_inbox.empty()) {
                    const auto message = gateway.own_inbox.front();
                    gateway.own_inbox.pop_front();
                    turn([&] { gateway.exporter->own_message(message, now); });
                    any = true;
                }
                if (gateway.alive && std::exchange(gateway.again, false)) {
                    if (between_turns) between_turns();
                    turn([&] { gateway.exporter->sent(now); });
                    any = true;
                }
            }
        }
    }

    void home_assistant_reads(const mqtt::Message& message) {
        if (!topic_matches("homeassistant/device/+/config", message.topic)) return;
        if (message.payload.empty()) {
            devices.erase(message.topic);
            return;
        }
        const auto document = nlohmann::json::parse(message.payload);
        auto& device = devices[message.topic];
        for (const auto& [id, component] : document["cmps"].items()) {
            const auto entry = component["p"].get<std::string>() + " " + id;
            if (component.size() == 1)
                device.erase(entry);
            else
                device.insert(entry);
        }
    }

    Exporter::Port port(Gateway* gateway) {
        Exporter::Port port;
        port.connect = [this, gateway] {
            gateway->own = true;
            gateway->own_granted = gateway->own_up = false;
            gateway->will = gateway->exporter->will();
            for (const auto& filter : gateway->exporter->own_subscriptions()) {
                gateway->own_filters.insert(filter);
                replay(filter, gateway->own_inbox);
            }
        };
        port.disconnect = [gateway] {
            gateway->own = false;
            gateway->own_filters.clear();
            gateway->own_inbox.clear();
        };
        port.publish = [this, gateway](mqtt::Message message) {
            if (gateway->room > 0) --gateway->room;
            publish(message, gateway);
        };
        port.has_room = [gateway] { return gateway->room > 0; };
        port.again = [gateway] { gateway->again = true; };
        port.discard = [] {};  // nothing waits
        port.subscribe = [this, gateway](const std::string& filter) {
            gateway->own_filters.insert(filter);
            gateway->own_granted = false;
            replay(filter, gateway->own_inbox);
        };
        port.watch = [gateway](const std::string& filter) { gateway->own_filters.insert(filter); };
        port.unsubscribe = [gateway](const std::string& filter) { gateway->own_filters.erase(filter); };
        port.ready = [] { return true; };
        port.boards = [this] {
            std::vector<std::string> names;
            for (const auto& [name, board] : boards)
                names.push_back(name);
            return names;
        };
        port.board = [this](const std::string& name) -> std::optional<Exporter::Present> {
            ++looks;
            const auto found = boards.find(name);
            if (found == boards.end()) return std::nullopt;
            return Exporter::Present{found->second.there,
                                     std::make_shared<const ExportedBoard>(found->second.board),
                                     found->second.there ? "online" : "lost", found->second.session};
        };
        port.value = [this](const std::string& board, const Property& property) {
            const auto& of = boards[board];
            if (const auto found = of.known.find(property.id); found != of.known.end())
                return std::optional(found->second);
            const auto found = of.values.find(property.service);
            return found == of.values.end() ? std::nullopt
                                            : value_in(property, nlohmann::json::parse(found->second));
        };
        port.refused = [this](std::uint64_t values) { refused += values; };
        port.want = [](const std::string&, const std::string&, double) { return nullptr; };
        port.command = [gateway](const std::string& board, const Request& request,
                                 std::function<void(std::string)> done) {
            gateway->commands.emplace_back(board, request);
            gateway->answers.push_back(std::move(done));
        };
        port.log = [gateway](const std::string& sentence) { gateway->log.push_back(sentence); };
        port.wall_ms = [this] {
            return std::chrono::floor<std::chrono::milliseconds>(now.time_since_epoch()).count();
        };
        return port;
    }

    std::uint64_t seed_;
    int sessions_ = 0;
    std::shared_ptr<const Dialect> dialect_;
};

/// A board with these distance sensors and, where it is asked for, a servo.
inline ExportedBoard exported(int sensors, bool servo = true, const std::string& name = "Desk") {
    ExportedBoard board;
    board.name = name;
    for (int i = 0; i < sensors; ++i) {
        Property property;
        property.id = "distance/" + std::to_string(i);
        property.service = "distance";
        property.name = "Distance " + std::to_string(i);
        property.read = property::Place{"distance", "/distance/" + std::to_string(i)};
        board.properties.push_back(property);
    }
    if (servo) {
        Property property;
        property.id = "servo/0/angle";
        property.service = "servo";
        property.name = "Servo angle";
        property.kind = Kind::kNumber;
        property.min = 0;
        property.max = 180;
        property.whole = true;
        property.write = property::Call{"servo", "write", {0, std::nullopt}};
        board.properties.push_back(property);
    }
    return board;
}

/// A strip of pixels with brightness and color.
inline Property strip_of_pixels() {
    Property property;
    property.id = "pixels/light";
    property.service = "pixels";
    property.name = "Pixels";
    property.kind = Kind::kLight;
    property.write = property::Call{"pixels", "brightness", {std::nullopt}};
    property.color = property::Call{"pixels", "fill", {std::nullopt}};
    return property;
}

inline Property stop_button() {
    Property property;
    property.id = "motors/stop";
    property.service = "motors";
    property.name = "Motors stop";
    property.kind = Kind::kButton;
    property.write = property::Call{"motors", "stop", {}};
    return property;
}

}  // namespace asip::gateway::exports
