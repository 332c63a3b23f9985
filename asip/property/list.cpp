// SPDX-License-Identifier: Apache-2.0
#include "asip/property/list.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include "asip/property/service_properties.hpp"
#include "asip/property/value.hpp"

namespace asip::property {
namespace {

/// Unit and bounds are those of the value, behind the meaning's straight line.
void give(Property& property, const model::Meaning& meaning) {
    property.meaning = meaning;
    if (!meaning.unit.empty()) property.unit = meaning.unit;
    if (!meaning.line || property.kind != Kind::kSensor || !property.choices.empty()) return;
    property.whole = false;
    if (property.min) property.min = on_line(*meaning.line, *property.min);
    if (property.max) property.max = on_line(*meaning.line, *property.max);
    if (property.min && property.max && *property.min > *property.max) std::swap(property.min, property.max);
}

}  // namespace

std::vector<Property> properties_of(const model::Description& description, const FindModel& find_model) {
    std::vector<Property> result;
    const model::ServiceInfo* io = nullptr;
    const auto append = [&](std::vector<Property> more) {
        if (more.size() > kMaxOfService) more.resize(kMaxOfService);
        std::move(more.begin(), more.end(), std::back_inserter(result));
    };
    for (const auto& service : description.services) {
        const auto model = find_model(service);
        if (!model) continue;
        if (model->name == "io")
            io = &service;
        else
            append(service_properties(description, service, *model));
    }
    if (io != nullptr) append(pin_properties(description, *io));
    if (result.size() > kMaxProperties) result.resize(kMaxProperties);
    for (auto& property : result) {
        if (!property.choices.empty() || property.kind == Kind::kLight) property.whole = false;
        const auto meaning = description.labels.meanings.find(property.id);
        if (meaning != description.labels.meanings.end()) give(property, meaning->second);
    }
    return result;
}

}  // namespace asip::property
