// SPDX-License-Identifier: Apache-2.0
#include "agent/command/error_report.hpp"

#include <nlohmann/json.hpp>

#include "asip/model/json.hpp"
#include "asip/model/names.hpp"

namespace asip::agent {

namespace {
constexpr std::size_t kMaxRequestShown = 128;
}

std::string service_named(const session::ServiceTable& services, char letter) {
    if (const auto* service = services.find(letter)) return service->name;
    std::string name(1, letter);
    return model::valid_name(name) && letter != 'I' ? name : "io";
}

std::string service_of_line(const session::ServiceTable& services, std::string_view line) {
    return service_named(services, line.size() > 1 && line[1] == ',' ? line[0] : '#');
}

std::string_view request_of_line(std::string_view line) {
    return line.size() > 2 && line[1] == ',' ? line.substr(2) : line;
}

void publish_error(const Board& board, std::string_view service, const nlohmann::json& value, Effects& out) {
    out.publish.push_back({mqtt::Message{.topic = board.topics.service_error(board.name, service),
                                         .payload = model::dump_json(value)},
                           mqtt::Priority::kContext});
}

void report_failure(const Board& board, const Failure& failure, Effects& out) {
    nlohmann::json value{{"request", std::string(failure.request.substr(0, kMaxRequestShown))},
                         {"reason", std::string(failure.reason)},
                         {"error", std::string(failure.error)}};
    if (!failure.by.empty()) value["by"] = std::string(failure.by);
    if (failure.dropped > 0) value["dropped"] = failure.dropped;
    publish_error(board, failure.service, value, out);
}

}  // namespace asip::agent
