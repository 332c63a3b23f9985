#include "registry/query_service.hpp"

#include <utility>

#include "asip/bus/request_envelope.hpp"

namespace asip::registry {
namespace {

constexpr std::size_t kMaxForgottenAtOnce = 1000;

}  // namespace

QueryService::QueryService(std::string registry, Dependencies dependencies)
    : registry_(std::move(registry)), dependencies_(std::move(dependencies)) {}

bus::Answer QueryService::refused(std::string reason, std::string error) {
    bus::Answer answer;
    answer.refused = std::move(reason);
    answer.error = std::move(error);
    return answer;
}

std::optional<mqtt::Message> QueryService::answer(const mqtt::Message& request) {
    auto envelope = bus::open_envelope(request);
    const bus::ReplyTo& reply = envelope ? envelope->reply : envelope.error().reply;
    if (request.retain || !reply.wanted()) return std::nullopt;
    bus::Answer answer;
    if (!envelope) {
        answer = refused("invalid", envelope.error().error);
    } else if (envelope->form != bus::RequestEnvelope::Form::kJson) {
        answer = refused("invalid", "a query is a JSON object, such as {\"find\":\"boards\"}");
    } else {
        answer = answer_to(envelope->object);
    }
    answer.id = reply.id;
    answer.registry = registry_;
    answer.epoch = epoch_;
    answer.settling = settling_;
    mqtt::Message message;
    message.topic = reply.topic;
    message.correlation = reply.correlation;
    message.qos = 1;
    message.payload = bus::encode(answer);
    return message;
}

bus::Answer QueryService::answer_to(const nlohmann::json& object) {
    auto request = bus::read_registry_request(object);
    if (!request) return refused("invalid", request.error());
    if (auto* query = std::get_if<bus::Query>(&*request)) return find(std::move(*query));
    return forget(std::get<bus::Forget>(*request));
}

bus::Answer QueryService::find(bus::Query query) {
    if (query.find == bus::Find::kHistory) {
        if (!dependencies_.history) {
            return refused("no-history", "this registry keeps no history; start it with --history FILE");
        }
        auto history = dependencies_.history(query);
        return history ? std::move(*history) : refused("invalid", history.error());
    }
    for (;;) {
        auto answer = dependencies_.catalogue.find(query, dependencies_.now());
        if (!answer) return refused("invalid", answer.error());
        // Room for the envelope is a guess that errs on the safe side.
        if (max_bytes_ == 0 || query.limit == 1 || bus::encode(*answer).size() + 1024 <= max_bytes_) {
            return std::move(*answer);
        }
        query.limit = std::max<std::size_t>(1, std::min(query.limit, bus::Query::kMaxPage) / 2);
    }
}

bus::Answer QueryService::forget(const bus::Forget& forget) {
    Catalogue& catalogue = dependencies_.catalogue;
    const Instant now = dependencies_.now();
    const bool pattern = forget.board.find_first_of("*?") != std::string::npos;
    bus::Answer answer;
    if (!pattern) {
        const auto known = catalogue.board(forget.board, now);
        if (!known) return refused("unknown-board", "no board \"" + forget.board + "\" is known");
        if (known->state != "lost" && known->state != "offline") {
            return refused("alive",
                           "board \"" + forget.board + "\" is " + known->state +
                               " and would be back with its next announcement; stop its agent first");
        }
        answer.forgotten = {forget.board};
    } else {
        answer.forgotten = catalogue.forgettable(forget.board);
        if (answer.forgotten.size() > kMaxForgottenAtOnce) answer.forgotten.resize(kMaxForgottenAtOnce);
    }
    if (!forget.dry_run) {
        for (const std::string& board : answer.forgotten) {
            if (auto events = catalogue.forget(board, now.time)) dependencies_.forgotten(*events);
        }
    }
    answer.seq = catalogue.seq();
    return answer;
}

}  // namespace asip::registry
