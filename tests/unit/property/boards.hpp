// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "asip/property/list.hpp"

/// Boards of standard services for tests of properties.
namespace asip::property::test {

inline model::ModelPtr standard(const model::ServiceInfo& service) {
    return model::ModelSet::standard().find(service.name);
}

inline void add_service(model::Description& description, const std::string& name,
                        std::optional<int> count = std::nullopt) {
    model::ServiceInfo info;
    info.name = name;
    const auto model = model::ModelSet::standard().find(name);
    info.id = model ? model->id : 'X';
    info.count = count;
    description.services.push_back(info);
}

/// An Uno's pins, all free, with six analog channels, and the services.
inline model::Description board_with(const std::vector<std::string>& services) {
    model::Description description;
    description.board = "desk";
    description.pins.capabilities = std::string(14, '1') + std::string(6, '3');
    description.pins.owners = std::string(20, '-');
    description.pins.modes = std::string(20, '0');
    for (std::uint8_t channel = 0; channel < 6; ++channel)
        description.pins.analog.emplace_back(static_cast<std::uint8_t>(14 + channel), channel);
    for (const auto& service : services)
        add_service(description, service);
    return description;
}

inline std::vector<Property> properties(const model::Description& description) {
    return properties_of(description, standard);
}

inline const Property& property(const std::vector<Property>& all, const std::string& id) {
    static const Property none;
    for (const auto& each : all)
        if (each.id == id) return each;
    ADD_FAILURE() << "no property " << id;
    return none;
}

inline std::vector<std::string> ids(const std::vector<Property>& all) {
    std::vector<std::string> result;
    for (const auto& each : all)
        result.push_back(each.id);
    return result;
}

}  // namespace asip::property::test
