// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "asip/catalogue/bus_view.hpp"

namespace asip::cli {

/// A description as an agent publishes it: three standard services and one without a description.
inline constexpr const char* kUno1 =
    R"({"board":"uno1","session":"5f3a9c01","seq":3,"lease":60,)"
    R"("firmware":{"protocol":"0.4","chip":"ATmega328P","sketch":"AsipHello","extensions":{"E":1,"I":1}},)"
    R"("link":{"kind":"serial","path":"/dev/ttyACM0","baud":500000},)"
    R"("agent":{"version":"0.1.0","host":"pi","client":"asip-agent-1"},)"
    R"("pins":{"capabilities":"11151511515511333333","owners":"@@IIIIIIISDIIIIIIIII","modes":"66111111177111444444",)"
    R"("analog":{"14":0,"15":1}},)"
    R"("services":[{"name":"io","id":"I","model":"io@1","title":"ASIP core IO"},)"
    R"({"name":"distance","id":"D","model":"distance@1","title":"Distance","count":2,"period":100},)"
    R"({"name":"servo","id":"S","model":"servo@1","title":"Servos","count":1},)"
    R"({"name":"X","id":"X","title":"Unknown thing"}]})";

/// A board that announced itself by this description and as online, long ago: without times.
inline bus::BoardItem announced(const char* description = kUno1) {
    const auto name = model::parse_description(description)->board;
    catalogue::BusView view{bus::Topics()};
    const catalogue::Instant now{Time{} + std::chrono::hours(1), {}};
    view.apply({.topic = "asip/servicebus/" + name + "/$state", .payload = "online", .retain = true},
               now.time);
    view.apply({.topic = "asip/servicebus/" + name + "/$description", .payload = description, .retain = true},
               now.time);
    auto item = *view.board(name, now);
    item.first_seen = item.since = {};
    item.state_age = -1;
    item.description.clear();
    return item;
}

}  // namespace asip::cli
