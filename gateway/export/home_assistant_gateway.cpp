// SPDX-License-Identifier: Apache-2.0
// The device of the gateway itself, whose entities are diagnostics.
#include "gateway/export/home_assistant.hpp"
#include "gateway/export/object_text.hpp"

namespace asip::gateway::exports {

void HomeAssistant::describe_origin(ObjectText& document) const {
    auto origin = document.object("o");
    origin.add("name", "asip-gateway");
    if (!options_.version.empty()) origin.add("sw", options_.version);
}

std::string HomeAssistant::gateway_document(const std::vector<std::string>& /*boards*/,
                                            const std::string& /*on_bus*/) const {
    const auto id = gateway_id();
    std::string text;
    {
        ObjectText document(text);
        {
            auto device = document.object("dev");
            device.add_json("ids", "[\"" + id + "\"]").add("name", "ASIP gateway").add("mf", "ASIP");
            if (!options_.version.empty()) device.add("sw", options_.version);
            if (!options_.page.empty()) device.add("cu", options_.page);
        }
        describe_origin(document);
        auto all = document.object("cmps");
        const auto describe = [&id](ObjectText& component, const char* platform, const std::string& name,
                                    const char* title) {
            component.add("p", platform).add("uniq_id", id + "_" + name).add("name", title);
            component.add("ent_cat", "diagnostic");
        };
        {
            auto connection = all.object("connection");
            describe(connection, "binary_sensor", "connection", "Connection");
            connection.add("dev_cla", "connectivity").add("stat_t", gateway_state());
            connection.add("pl_on", online()).add("pl_off", leaving());
        }
        {
            auto boards = all.object("boards");
            describe(boards, "sensor", "boards", "Boards online");
            boards.add("stat_t", standing_topic()).add("val_tpl", "{{ value_json.boards }}");
            boards.add("avty_t", gateway_state());
        }
        if (!options_.started.empty()) {
            auto started = all.object("started");
            describe(started, "sensor", "started", "Started");
            started.add("dev_cla", "timestamp").add("stat_t", standing_topic());
            started.add("val_tpl", "{{ value_json.started }}");
        }
    }
    return text;
}

std::string HomeAssistant::standing(std::size_t boards_online) const {
    std::string text;
    {
        ObjectText standing(text);
        standing.add_number("boards", static_cast<double>(boards_online));
        if (!options_.started.empty()) standing.add("started", options_.started);
    }
    return text;
}

}  // namespace asip::gateway::exports
