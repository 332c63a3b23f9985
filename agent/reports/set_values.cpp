// SPDX-License-Identifier: Apache-2.0
#include "agent/reports/set_values.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "asip/model/json.hpp"

namespace asip::agent {

namespace {

using nlohmann::json;

constexpr char kReportTag = 'A';

/// Whether it switches an output: something undoes it, or it undoes another. Of such commands the last one
/// for an element counts.
bool is_output(const model::ServiceModel& model, const model::CommandModel& command) {
    if (command.safe) return true;
    return std::any_of(model.commands.begin(), model.commands.end(),
                       [&](const auto& other) { return other.safe && other.safe->command == command.name; });
}

/// What one request sets: values by element, or one value for the whole service (element "").
std::vector<std::pair<std::string, json>> settings_of(const model::ServiceModel& model,
                                                      const model::RequestValues& request) {
    const auto args = model::given_arguments(*request.command);
    const auto& values = request.values;
    if (args.size() != values.size() || args.empty()) return {};
    const auto is_element = [&](const model::Field& field) {
        return !model.element.empty() && field.name == model.element &&
               field.type == model::ValueType::kInteger;
    };
    // {"pixels":[[0,255],[1,128]]}: each item is an element.
    const auto& only = *args.front();
    if (args.size() == 1 && only.type == model::ValueType::kList && only.items.size() == 2 &&
        is_element(only.items.front())) {
        std::vector<std::pair<std::string, json>> each;
        for (const auto& item : values.front())
            if (item.is_array() && item.size() == 2) each.emplace_back(model::dump_json(item[0]), item[1]);
        return each;
    }
    const std::size_t first = is_element(only) ? 1 : 0;
    json value = true;
    if (args.size() - first == 1) value = values[first];
    if (args.size() - first > 1) {
        value = json::object();
        for (std::size_t i = first; i < args.size(); ++i)
            value[args[i]->name] = values[i];
    }
    return {{first == 1 ? model::dump_json(values.front()) : std::string(), std::move(value)}};
}

}  // namespace

// --- of one service

void SettingsOfService::apply(const model::ServiceModel& model, const model::RequestValues& request,
                              bool executed) {
    const auto& command = *request.command;
    if (command.answer != 0) return;  // a question
    // `stop-all`, `clear`: what it changes is not said.
    if (request.values.empty()) {
        std::vector<std::string> names;
        for (const auto& [name, elements] : commands_)
            if (const auto* known = model.command(name); known == nullptr || known->tag != kReportTag)
                names.push_back(name);
        for (const auto& name : names)
            drop_command(name);
        return;
    }
    const bool output = is_output(model, command);
    for (auto& [element, value] : settings_of(model, request)) {
        if (output)
            for (const auto& other : model.commands)
                if (is_output(model, other)) {
                    if (element.empty())
                        drop_command(other.name);
                    else
                        drop(other.name, element);
                }
        drop(command.name, element);
        if (executed) put(command.name, element, std::move(value));
    }
    while (bytes_ > kMaxBytes)
        drop_oldest();
}

void SettingsOfService::put(const std::string& command, const std::string& element, json value) {
    // With quotes, colon, comma; a command that has a single element has its braces, too.
    const std::size_t bytes = command.size() + element.size() + model::dump_json(value).size() + 10;
    bytes_ += bytes;
    commands_[command][element] = {std::move(value), ++last_, bytes};
}

void SettingsOfService::drop(const std::string& command, const std::string& element) {
    const auto known = commands_.find(command);
    if (known == commands_.end()) return;
    if (const auto setting = known->second.find(element); setting != known->second.end()) {
        bytes_ -= setting->second.bytes;
        known->second.erase(setting);
    }
    if (known->second.empty()) commands_.erase(known);
}

void SettingsOfService::drop_command(const std::string& command) {
    const auto known = commands_.find(command);
    if (known == commands_.end()) return;
    for (const auto& [element, setting] : known->second)
        bytes_ -= setting.bytes;
    commands_.erase(known);
}

void SettingsOfService::drop_oldest() {
    const std::string* command = nullptr;
    const std::string* element = nullptr;
    std::uint64_t oldest = last_ + 1;
    for (const auto& [name, elements] : commands_)
        for (const auto& [key, setting] : elements)
            if (setting.number < oldest) {
                oldest = setting.number;
                command = &name;
                element = &key;
            }
    drop(std::string(*command), std::string(*element));
}

void SettingsOfService::clear() {
    commands_.clear();
    bytes_ = 0;
}

std::string SettingsOfService::text() const {
    if (commands_.empty()) return {};
    json object = json::object();
    for (const auto& [command, elements] : commands_)
        for (const auto& [element, setting] : elements) {
            if (element.empty())
                object[command] = setting.value;
            else
                object[command][element] = setting.value;
        }
    return model::dump_json(object);
}

// --- of a board

void SetValues::queued(session::RequestId id, std::string_view line) {
    if (line.empty()) return;
    const auto* service = board_.services.find(line[0]);
    if (service != nullptr && service->model) requests_.emplace(id, line);
}

void SetValues::on_finished(const session::Finished& end, Time now) {
    using session::Ending;
    const auto request = requests_.find(end.id);
    if (request == requests_.end()) return;
    const std::string line = std::move(request->second);
    requests_.erase(request);
    if (end.ending == Ending::kNotSent || end.ending == Ending::kBoardError) return;
    const bool perhaps = end.ending == Ending::kTimeout || end.ending == Ending::kDoubt;
    apply(line, !perhaps, now);
}

void SetValues::apply(std::string_view line, bool executed, Time now) {
    const auto* entry = line.size() < 3 ? nullptr : board_.services.find(line[0]);
    if (entry == nullptr || !entry->model) return;
    const auto request = model::request_values(*entry->model, line.substr(2));
    if (!request) return;
    auto* known = known_or_new(entry->name);
    if (known == nullptr) return;
    known->settings.apply(*entry->model, *request, executed);
    note(*known, now);
}

SetValues::Service* SetValues::known_or_new(std::string_view name) {
    const auto known = services_.find(name);
    if (known != services_.end()) return &known->second;
    if (services_.size() >= kMaxServices) return nullptr;
    return &services_.emplace(std::string(name), Service{}).first->second;
}

void SetValues::note(Service& service, Time now) {
    service.changed = true;
    const Time when = std::max(now, service.not_before);
    if (!due_ || when < *due_) due_ = when;
}

void SetValues::forget(Time now) {
    for (auto& [name, service] : services_) {
        service.settings.clear();
        note(service, now);
    }
}

void SetValues::stored(std::string_view service, std::string_view payload, Time now) {
    if (payload.empty()) return;
    auto* known = known_or_new(service);
    if (known == nullptr || known->settings.text() == payload) return;
    known->again = true;
    note(*known, now);
}

void SetValues::connected(Time now) {
    for (auto& [name, service] : services_) {
        service.again = true;
        note(service, now);
    }
}

void SetValues::hurry(Time now) {
    for (auto& [name, service] : services_)
        service.not_before = now;
    due_ = now;
}

void SetValues::publish(Time now, Effects& out) {
    if (!due_ || now < *due_) return;
    due_.reset();
    for (auto& [name, service] : services_) {
        if (!service.changed) continue;
        if (now < service.not_before) {
            if (!due_ || service.not_before < *due_) due_ = service.not_before;
            continue;
        }
        service.changed = false;
        auto text = service.settings.text();
        if (!std::exchange(service.again, false) && text == service.said) continue;
        service.said = text;
        service.not_before = now + kBetween;
        mqtt::Message message;
        message.topic = board_.topics.service_set(board_.name, name);
        message.payload = std::move(text);
        message.qos = 1;
        message.retain = true;
        out.publish.push_back({std::move(message), mqtt::Priority::kAnnouncement});
    }
}

std::optional<Time> SetValues::next_deadline() const {
    return due_;
}

}  // namespace asip::agent
