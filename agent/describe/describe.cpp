// SPDX-License-Identifier: Apache-2.0
#include "agent/describe/describe.hpp"

#include "asip/model/names.hpp"

namespace asip::agent {

namespace {

std::optional<int> lookup(const std::map<char, int>& values, char letter) {
    const auto it = values.find(letter);
    if (it == values.end()) return std::nullopt;
    return it->second;
}

model::PinsInfo describe_pins(const session::Identity& board) {
    model::PinsInfo pins;
    pins.owners = board.pin_owners;
    for (auto capability : board.pin_capabilities)
        pins.capabilities += static_cast<char>('0' + (capability & 7));
    for (auto mode : board.pin_modes)
        pins.modes += static_cast<char>('0' + static_cast<int>(mode));
    pins.analog = board.analog_pins;
    return pins;
}

}  // namespace

model::Description describe(const session::Identity& board, const session::ServiceTable& services,
                            const model::ModelSet& models, const BoardFacts& facts) {
    model::Description description;
    description.firmware = {board.info.protocol(), board.info.chip, board.info.sketch, board.extensions};
    description.link = facts.link;
    description.agent = facts.agent;
    description.pins = describe_pins(board);
    description.labels = facts.labels;
    description.labels_fault = facts.labels_fault;
    description.on_demand = facts.on_demand;
    for (const auto& entry : services.entries()) {
        model::ServiceInfo service;
        service.name = entry.name;
        service.id = entry.letter;
        service.title = entry.title;
        if (entry.model && models.is_standard(*entry.model)) service.model = entry.model->ref();
        if (entry.model && service.model.empty()) service.own_model = entry.model;
        service.count = lookup(facts.counts, entry.letter);
        service.period = lookup(facts.periods, entry.letter);
        description.services.push_back(std::move(service));
    }
    return description;
}

std::string name_from_link(const model::LinkInfo& link) {
    std::string_view text = link.path;
    if (link.kind == "serial") text = text.substr(text.rfind('/') + 1);
    return model::suggest_name(text);
}

}  // namespace asip::agent
