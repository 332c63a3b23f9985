// SPDX-License-Identifier: Apache-2.0
#include "agent/inbound/inbound.hpp"

#include <type_traits>
#include <utility>

#include "agent/inbound/command_age.hpp"
#include "asip/bus/request/agent_requests.hpp"

namespace asip::agent {

namespace {

using bus::TopicKind;

BusRequest read_request(const mqtt::Message& message, std::string_view service, const CommandAge& age,
                        Time now) {
    BusRequest request{message.topic, std::string(service), message.payload, message.retain, {}};
    if (auto envelope = bus::open_envelope(message)) {
        request.envelope = std::move(*envelope);
    } else {
        request.envelope.reply = std::move(envelope.error().reply);
        request.fault = std::move(envelope.error().error);
    }
    request.arrival = age.sent_at(message, request.envelope.sent, now);
    return request;
}

bool is_renewal(const BusRequest& request, const session::ServiceTable& services) {
    if (request.service.empty() || !request.envelope.object.contains("renew")) return false;
    const auto* service = services.find(request.service);
    return service != nullptr && service->model && service->model->command("renew") == nullptr;
}

Renewal read_renewal(BusRequest request) {
    const auto& which = request.envelope.object.at("renew");
    Renewal renewal;
    if (which.is_string())
        renewal.id = which.get<std::string>();
    else if (which.is_number())
        renewal.id = which.dump();
    else if (which != nlohmann::json(true))
        request.fault = "\"renew\" must be the id of a command, or true";
    static_cast<BusRequest&>(renewal) = std::move(request);
    return renewal;
}

Stop read_stop(BusRequest request) {
    Stop stop;
    const auto& object = request.envelope.object;
    if (object.is_object()) {
        stop.latch = object.contains("latch") && object.at("latch") == nlohmann::json(true);
        if (const auto why = object.find("why"); why != object.end() && why->is_string())
            stop.why = why->get<std::string>();
    }
    static_cast<BusRequest&>(stop) = std::move(request);
    return stop;
}

/// What the members of the request say that it is. A request that cannot be executed as it is stays a
/// command.
Inbound kind_by_content(BusRequest request, const session::ServiceTable& services) {
    const bool readable = !request.retained && request.fault.empty() &&
                          request.envelope.form == bus::RequestEnvelope::Form::kJson;
    if (!readable) return Command{std::move(request)};
    const auto& object = request.envelope.object;
    if (is_renewal(request, services)) return read_renewal(std::move(request));
    if (!request.service.empty()) return Command{std::move(request)};
    if (object.contains("resume")) return Resume{std::move(request)};
    if (bus::is_port_request(object)) {
        auto wanted = bus::read_port_request(object);
        return PortRequest{std::move(request), std::move(wanted)};
    }
    if (bus::is_label_request(object)) {
        auto change = bus::read_label_request(object);
        return LabelRequest{std::move(request), std::move(change)};
    }
    return Command{std::move(request)};
}

std::size_t bytes_of(const nlohmann::json& value) {
    std::size_t bytes = sizeof value;
    if (value.is_string()) bytes += sizeof(std::string) + value.get_ref<const std::string&>().capacity();
    if (value.is_structured()) bytes += sizeof(nlohmann::json::array_t);
    if (value.is_array())
        for (const auto& item : value)
            bytes += bytes_of(item);
    if (value.is_object())
        for (const auto& [name, member] : value.items())
            bytes += 4 * sizeof(void*) + sizeof(std::string) + name.capacity() + bytes_of(member);
    return bytes;
}

std::size_t bytes_of(const BusRequest& request) {
    const auto& envelope = request.envelope;
    std::size_t bytes = request.topic.capacity() + request.service.capacity() + request.payload.capacity() +
                        request.fault.capacity() + envelope.text.capacity() + envelope.sent.capacity() +
                        bytes_of(envelope.object);
    for (const auto* text :
         {&envelope.reply.topic, &envelope.reply.correlation, &envelope.reply.id, &envelope.reply.by})
        bytes += text->capacity();
    return bytes;
}

}  // namespace

std::optional<Inbound> read_inbound(const mqtt::Message& message, const Addressee& to, const CommandAge& age,
                                    Time now) {
    const auto topic = to.topics.parse(message.topic);
    if (!topic) return std::nullopt;
    if (topic->kind == TopicKind::kProbe) return Announcement{message};
    if (topic->board != to.board) return std::nullopt;
    switch (topic->kind) {
        case TopicKind::kState:
        case TopicKind::kDescription:
            return Announcement{message};
        case TopicKind::kDemand:
            if (message.retain) return Leftover{message.topic};
            return DemandMessage{std::string(topic->demander), message.payload};
        case TopicKind::kLink: {
            if (message.retain) return std::nullopt;
            LinkRequest request;
            static_cast<BusRequest&>(request) = read_request(message, {}, age, now);
            request.user = topic->demander.substr(0, topic->demander.find('/'));
            return request;
        }
        case TopicKind::kServiceSet:
            if (!message.retain || message.payload.empty()) return std::nullopt;
            return Leftover{message.topic};
        case TopicKind::kStop:
            return read_stop(read_request(message, {}, age, now));
        case TopicKind::kServiceIn:
            return kind_by_content(read_request(message, topic->service, age, now), to.services);
        case TopicKind::kBoardOut:
            if (!to.client_side) return std::nullopt;
            return kind_by_content(read_request(message, {}, age, now), to.services);
        case TopicKind::kBoardIn: {
            auto inbound = kind_by_content(read_request(message, {}, age, now), to.services);
            // There the lines of the board go: only a request that wants an answer is meant for us.
            const auto* command = std::get_if<Command>(&inbound);
            if (to.client_side && command != nullptr && !command->reply().wanted()) return std::nullopt;
            return inbound;
        }
        default:
            return std::nullopt;
    }
}

const BusRequest* request_of(const Inbound& inbound) {
    return std::visit(
        [](const auto& known) -> const BusRequest* {
            if constexpr (std::is_base_of_v<BusRequest, std::decay_t<decltype(known)>>)
                return &known;
            else
                return nullptr;
        },
        inbound);
}

bool same_client(const BusRequest& a, const BusRequest& b) {
    using Topics = bus::ReplyTopics;
    return a.reply().wanted() && a.reply().by == b.reply().by &&
           Topics::without_urgent(a.reply().topic) == Topics::without_urgent(b.reply().topic);
}

bool sent_behind(const Stop& stop, const Inbound& message) {
    const auto* request = request_of(message);
    return request != nullptr && stop.arrival.told && request->arrival.told && !stop.reply().by.empty() &&
           request->reply().by == stop.reply().by && *request->arrival.told > *stop.arrival.told;
}

bool takes_turns(const Inbound& inbound) {
    return std::holds_alternative<Command>(inbound) || std::holds_alternative<PortRequest>(inbound) ||
           std::holds_alternative<LabelRequest>(inbound) || std::holds_alternative<LinkRequest>(inbound);
}

std::size_t bytes_of(const Inbound& inbound) {
    const auto* request = request_of(inbound);
    return sizeof inbound + (request == nullptr ? 0 : bytes_of(*request));
}

}  // namespace asip::agent
