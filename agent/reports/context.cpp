// SPDX-License-Identifier: Apache-2.0
#include "agent/reports/context.hpp"

#include <nlohmann/json.hpp>

#include "agent/command/error_report.hpp"
#include "asip/model/event_decoder.hpp"
#include "asip/model/json.hpp"

namespace asip::agent {

void Context::on_line(const std::string& board, const protocol::ParsedLine& line,
                      const session::Identity& identity, const session::ServiceTable& services, Effects& out,
                      std::string_view by) {
    mqtt::Message raw;
    raw.topic = options_.client_side ? topics_.board_in(board) : topics_.board_out(board);
    raw.payload = line.text() + options_.terminator;
    out.publish.push_back({std::move(raw), mqtt::Priority::kContext});

    if (line.is_error()) {
        const auto error = line.error();
        nlohmann::json value{
            {"request", std::string(1, error.tag)}, {"code", error.code}, {"error", std::string(error.text)}};
        if (!by.empty()) value["by"] = std::string(by);
        return publish_error(topics_, board, service_named(services, error.service), value, out);
    }
    if (!line.is_event()) return;
    const auto event = line.event();
    const auto* service = services.find(event.service);
    if (service == nullptr) return;
    const auto value =
        service->model ? model::decode_event(*service->model, event, {&identity.port_map, identity.pin_modes})
                       : model::raw_event(event);
    if (!value) return;
    mqtt::Message message;
    message.topic = topics_.service_out(board, service->name);
    message.payload = model::dump_json(*value);
    message.retain = options_.retain_values;
    out.publish.push_back({std::move(message), mqtt::Priority::kContext});
}

}  // namespace asip::agent
