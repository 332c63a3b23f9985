// SPDX-License-Identifier: Apache-2.0
#include "agent/describe/describer.hpp"

#include <utility>

#include "asip/model/names.hpp"
#include "asip/model/port_name.hpp"
#include "asip/program/options.hpp"
#include "asip/protocol/body.hpp"

namespace asip::agent {

namespace {

std::optional<int> lookup(const std::map<char, int>& values, char letter) {
    const auto it = values.find(letter);
    if (it == values.end()) return std::nullopt;
    return it->second;
}

}  // namespace

Describer::Describer(const Board& board, const model::ModelSet& models, const ReportOptions& reports)
    : board_(board), models_(models) {
    if (reports.on_demand)
        on_demand_ = {static_cast<int>(reports.fastest.count()), static_cast<int>(reports.resting.count())};
}

void Describer::board_found(bool changed, const ReportPeriods& periods) {
    if (changed) counts_.clear();
    periods_ = periods_of(periods);
}

bool Describer::note_agent(model::AgentInfo agent) {
    if (agent.client == agent_.client) return false;
    agent_ = std::move(agent);
    return true;
}

bool Describer::note_labels(const LabelBook& labels) {
    if (labels_ == labels.current() && labels_fault_ == labels.fault()) return false;
    labels_ = labels.current();
    labels_fault_ = labels.fault();
    return true;
}

bool Describer::note_warnings(std::vector<std::string> warnings) {
    if (warnings_ == warnings) return false;
    warnings_ = std::move(warnings);
    return true;
}

bool Describer::note_stop(const std::optional<model::StopInfo>& stopped) {
    if (stopped_ == stopped) return false;
    stopped_ = stopped;
    return true;
}

bool Describer::note_event(const std::string& name, const nlohmann::json& event) {
    const auto* service = board_.services.find(std::string_view(name));
    if (service == nullptr || !service->model || event.size() != 1 || service->letter == 'I') return false;
    const int count = static_cast<int>(event.front().size());
    if (lookup(counts_, service->letter) == count) return false;
    const auto* model = service->model->event_named(event.begin().key());
    if (model == nullptr || model->shape != model::EventShape::kPerElement) return false;
    counts_[service->letter] = count;
    return true;
}

bool Describer::note_settings(const ReportPeriods& periods) {
    auto now = periods_of(periods);
    if (board_.session.identity().pin_modes == described_modes_ && now == periods_) return false;
    periods_ = std::move(now);
    return true;
}

std::map<char, int> Describer::periods_of(const ReportPeriods& periods) const {
    std::map<char, int> result;
    for (const auto& entry : board_.services.entries()) {
        // Not what demands bring about: the description would change with each subscriber.
        const auto period = periods.controls(entry.letter) ? periods.own_period(entry.letter)
                                                           : board_.session.period(entry.letter);
        if (period) result[entry.letter] = static_cast<int>(*period);
    }
    return result;
}

model::PinsInfo Describer::pins() const {
    const auto& board = board_.session.identity();
    model::PinsInfo pins;
    pins.owners = board.pin_owners;
    for (auto capability : board.pin_capabilities)
        pins.capabilities += static_cast<char>('0' + (capability & 7));
    for (auto mode : board.pin_modes)
        pins.modes += static_cast<char>('0' + static_cast<int>(mode));
    pins.analog = board.analog_pins;
    return pins;
}

// A board of ours that says no version is older than the first that did. ASIP 0.4 knows no versions.
model::FirmwareInfo Describer::firmware() const {
    const auto& board = board_.session.identity();
    model::FirmwareInfo firmware{board.info.protocol(), board.info.chip, board.info.sketch, board.extensions};
    const int version = board.extensions.version(protocol::kFirmware);
    if (version > 0) firmware.version = protocol::version_text(version);
    if (loadable_ > version && !board.extensions.empty() && link_.kind == "serial")
        firmware.available = protocol::version_text(loadable_);
    return firmware;
}

model::Description Describer::description() {
    const auto& board = board_.session.identity();
    link_.baud = static_cast<int>(board_.session.baud());
    described_modes_ = board.pin_modes;
    model::Description description;
    description.firmware = firmware();
    description.link = link_;
    description.agent = agent_;
    description.pins = pins();
    description.labels = labels_;
    description.labels_fault = labels_fault_;
    description.on_demand = on_demand_;
    description.warnings = warnings_;
    description.stopped = stopped_;
    for (const auto& entry : board_.services.entries()) {
        model::ServiceInfo service;
        service.name = entry.name;
        service.id = entry.letter;
        service.title = entry.title;
        if (entry.model && models_.is_standard(*entry.model)) service.model = entry.model->ref();
        if (entry.model && service.model.empty()) service.own_model = entry.model;
        service.count = lookup(counts_, entry.letter);
        service.period = lookup(periods_, entry.letter);
        description.services.push_back(std::move(service));
    }
    return description;
}

std::string Describer::name_from_link() const {
    return link_.kind == "serial" ? model::name_of_port(link_.path, program::host_name())
                                  : model::suggest_name(link_.path);
}

}  // namespace asip::agent
