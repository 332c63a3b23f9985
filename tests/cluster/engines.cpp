// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <stdexcept>
#include <utility>

#include "tests/cluster/node_engine.hpp"

namespace cluster {
namespace {

const std::array<std::pair<const char*, std::unique_ptr<Engine> (*)(const Hosts&)>, 3> kEngines{{
    {"mosquitto", make_mosquitto},
    {"bridges", make_bridged_mosquitto},
    {"rabbitmq", make_rabbitmq},
}};

}  // namespace

std::vector<std::string> engine_names() {
    std::vector<std::string> names;
    for (const auto& [name, make] : kEngines)
        names.emplace_back(name);
    return names;
}

std::unique_ptr<Engine> make_engine(const std::string& name, const Hosts& hosts) {
    for (const auto& [known, make] : kEngines)
        if (name == known) return make(hosts);
    throw std::runtime_error(
        fmt::format("there is no engine \"{}\"; those known are: {}", name, fmt::join(engine_names(), ", ")));
}

}  // namespace cluster
