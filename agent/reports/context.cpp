// SPDX-License-Identifier: Apache-2.0
#include "agent/reports/context.hpp"

#include <nlohmann/json.hpp>

#include "agent/command/error_report.hpp"
#include "asip/bus/request/line_service.hpp"
#include "asip/model/event_decoder.hpp"
#include "asip/model/json.hpp"
#include "asip/text/printable.hpp"

namespace asip::agent {

const session::ServiceTable::Entry* Context::service_of(const protocol::Event& event) const {
    const auto* service = board_.services.find(event.service);
    if (event.service != 'M' || service == nullptr || !service->model || service->model->event(event.tag))
        return service;
    // For a client that asks the motors for encoders, as robots of 2017 have it, steps come by M in place of
    // E.
    const auto* encoders = board_.services.find('E');
    const bool theirs = encoders != nullptr && encoders->model && encoders->model->event(event.tag);
    return theirs ? encoders : service;
}

std::optional<Context::Decoded> Context::decode(const protocol::ParsedLine& line) const {
    if (!line.is_event()) return std::nullopt;
    const auto event = line.event();
    const auto* service = service_of(event);
    if (service == nullptr) return std::nullopt;
    if (!service->model) return Decoded{service->name, model::raw_event(event)};
    const auto& identity = board_.session.identity();
    return Decoded{service->name,
                   model::decode_event(*service->model, event, {&identity.port_map, identity.pin_modes})};
}

void Context::publish(const protocol::ParsedLine& line, const std::optional<Decoded>& decoded, Effects& out,
                      std::string_view by) {
    const auto& topics = board_.topics;
    if (out.publish.empty()) out.publish.reserve(4);  // most lines make two
    const bool has_value = decoded && decoded->value;
    if (has_value) {  // first: links wait for it
        auto& value = out.publish.emplace_back();
        value.message.topic = topics.service_out(board_.name, decoded->service);
        value.message.payload = model::dump_json(*decoded->value);
        value.message.retain = options_.retain_values;
        value.priority = mqtt::Priority::kContext;
    }
    auto& raw = out.publish.emplace_back();
    raw.message.topic = options_.client_side ? topics.board_in(board_.name) : topics.board_out(board_.name);
    raw.message.payload = line.text() + options_.terminator;
    raw.priority = mqtt::Priority::kContext;

    if (line.is_error()) {
        const auto error = line.error();
        nlohmann::json value{
            {"request", std::string(1, error.tag)}, {"code", error.code}, {"error", std::string(error.text)}};
        if (!by.empty()) value["by"] = std::string(by);
        return publish_error(board_, service_named(board_.services, error.service), value, out);
    }
    if (decoded && !has_value) undecoded(decoded->service, line.text(), decoded->value.error(), out);
}

void Context::publish_line(Time now, Effects& out) {
    auto text = line_.take(now);
    if (text.empty()) return;
    auto& told = out.publish.emplace_back();
    told.message.topic = board_.topics.service_out(board_.name, bus::kLineService);
    told.message.payload = std::move(text);
    told.priority = mqtt::Priority::kContext;
}

void Context::undecoded(const std::string& service, std::string_view line, const std::string& why,
                        Effects& out) {
    ++undecoded_;
    const auto count = ++undecoded_of_[service];
    if (count == 1)
        out.log(program::log::Level::kWarning,
                "a report does not fit its service's model; only its line is published (further ones are "
                "counted)",
                {{"service", service}, {"line", text::printable(line)}, {"why", text::printable(why)}});
    if (count == kOften)
        warning_ = "reports of " + service +
                   " do not fit its model and are not published as values: " + text::printable(why);
}

}  // namespace asip::agent
