// SPDX-License-Identifier: Apache-2.0
#include "bench/load/board.hpp"

#include <utility>

#include "asip/bus/request/agent_requests.hpp"
#include "asip/bus/request/reply.hpp"
#include "asip/bus/request/request_envelope.hpp"
#include "asip/model/command_encoder.hpp"

namespace asip::load {
namespace {

using bus::Reply;
using bus::TopicKind;

Reply answer_to(const bus::RequestEnvelope& envelope, const BoardKind& kind, const bus::TopicRef& topic) {
    if (topic.kind == TopicKind::kBoardIn && envelope.form == bus::RequestEnvelope::Form::kJson)
        return Reply::refused(std::string(bus::kRefusedInvalid),
                              "a simulated board of asip-load takes request lines and labels only");
    if (topic.kind != TopicKind::kServiceIn) return Reply::ok(std::string(kProofSimulated));
    const auto* const service = kind.service(topic.service);
    if (service == nullptr)
        return Reply::refused(std::string(bus::kRefusedInvalid),
                              "the board has no service \"" + std::string(topic.service) + "\"");
    const auto command =
        envelope.form == bus::RequestEnvelope::Form::kJson
            ? model::encode_control_json(service->model.get(), service->model->id, envelope.object)
            : model::encode_control_text(service->model.get(), service->model->id, envelope.text);
    if (!command) return Reply::refused(std::string(bus::kRefusedInvalid), command.error());
    return Reply::ok(std::string(kProofSimulated));
}

}  // namespace

SimulatedBoard::SimulatedBoard(const bus::Topics& topics, const BoardKind& kind,
                               member::AnnouncerOptions options, model::Description description,
                               Random random)
    : topics_(topics),
      kind_(kind),
      name_(options.board),
      description_(std::move(description)),
      announcer_(topics, std::move(options), std::move(random)) {
    announcer_.describe(description_);
    member::Announcements nothing_yet;
    announcer_.set_state(model::BoardState::kOnline, model::StateReason::kNone, {}, nothing_yet);
}

std::vector<member::Announcer::Subscription> SimulatedBoard::subscriptions(const bus::Topics& topics,
                                                                           const std::string& name) {
    // The required ones are asked for first, and the claim of a name hears of its holder by its
    // description.
    auto all = member::Announcer::subscriptions(topics, name);
    for (auto& [filter, how] : all)
        how.required = filter == topics.description(name);
    for (auto&& filter : {topics.stop(name), topics.board_in(name), topics.service_in(name, "+")})
        all.push_back({filter, {.qos = 1, .no_local = true, .required = true}});
    return all;
}

bool SimulatedBoard::on_message(const mqtt::Message& message, Time now, member::Announcements& out) {
    const auto topic = topics_.parse(message.topic);
    if (!topic) return false;
    const bool command = topic->kind == TopicKind::kBoardIn || topic->kind == TopicKind::kServiceIn ||
                         topic->kind == TopicKind::kStop;
    if (command)
        answer(message, *topic, out);
    else
        announcer_.on_message(message, now, out);
    return command;
}

void SimulatedBoard::answer(const mqtt::Message& command, const bus::TopicRef& topic,
                            member::Announcements& out) {
    const auto envelope = bus::open_envelope(command);
    auto reply = !envelope ? Reply::refused(std::string(bus::kRefusedInvalid), envelope.error().error)
                 : command.retain
                     ? Reply::refused(std::string(bus::kRefusedRetained), "a stored command was not executed")
                 : topic.kind == TopicKind::kBoardIn && envelope->form == bus::RequestEnvelope::Form::kJson &&
                         bus::is_label_request(envelope->object)
                     ? label(envelope->object)
                     : answer_to(*envelope, kind_, topic);
    auto message = bus::reply_message(envelope ? envelope->reply : envelope.error().reply, std::move(reply));
    if (message) out.publish.push_back({std::move(*message), mqtt::Priority::kReply});
}

Reply SimulatedBoard::label(const nlohmann::json& wanted) {
    const auto change = bus::read_label_request(wanted);
    auto labels = change ? model::changed(description_.labels, *change) : fail(change.error());
    if (!labels) return Reply::refused(std::string(bus::kRefusedInvalid), labels.error());
    description_.labels = std::move(*labels);
    announcer_.describe(description_);
    return Reply::ok(std::string(bus::kProofKept));
}

void SimulatedBoard::report(member::Announcements& out) const {
    if (!announcer_.may_publish()) return;
    for (const auto& service : kind_.services) {
        if (service.value.empty()) continue;
        mqtt::Message message;
        message.topic = topics_.service_out(name_, service.model->name);
        message.payload = service.value;
        out.publish.push_back({std::move(message), mqtt::Priority::kContext});
    }
}

}  // namespace asip::load
