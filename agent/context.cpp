#include "agent/context.hpp"

#include <nlohmann/json.hpp>

#include "agent/error_report.hpp"
#include "asip/model/event_decoder.hpp"
#include "asip/model/json.hpp"
#include "asip/protocol/error_code.hpp"
#include "asip/protocol/message.hpp"

namespace asip::agent {

void Context::on_line(const std::string& board, std::string_view line, const session::Identity& identity,
                      const ServiceTable& services, Effects& out) {
    mqtt::Message raw;
    raw.topic = topics_.board_out(board);
    raw.payload = std::string(line) + options_.terminator;
    out.publish.push_back({std::move(raw), mqtt::Priority::kContext});

    const auto parsed = protocol::parse_line(line);
    mqtt::Message message;
    if (const auto* event = std::get_if<protocol::Event>(&parsed)) {
        const auto* service = services.find(event->service);
        if (!service || !service->model) return;
        const auto value =
            model::decode_event(*service->model, *event, {&identity.port_map, identity.pin_modes});
        if (!value) {
            if (service->model->event(event->tag)) ++undecoded_;
            return;
        }
        message.topic = topics_.service_out(board, service->name);
        message.payload = model::dump_json(*value);
        message.retain = options_.retain_values;
    } else if (const auto* error = std::get_if<protocol::ErrorReply>(&parsed)) {
        return publish_error(topics_, board, service_named(services, error->service),
                             {{"request", std::string(1, error->tag)},
                              {"code", error->code},
                              {"error", std::string(error->text)}},
                             out);
    } else {
        return;
    }
    out.publish.push_back({std::move(message), mqtt::Priority::kContext});
}

}  // namespace asip::agent
