// SPDX-License-Identifier: Apache-2.0
#include "asip/client/direct_transport.hpp"

#include <nlohmann/json.hpp>

#include "asip/bus/request/reply.hpp"
#include "asip/model/command_encoder.hpp"
#include "asip/model/event_decoder.hpp"
#include "asip/model/names.hpp"
#include "asip/protocol/message.hpp"

namespace asip::client {
namespace {

using Json = nlohmann::json;

constexpr PendingCalls::Id kOpeningRequest = ~PendingCalls::Id{0};  // no request id of a session

session::SessionOptions session_options(const Options& options) {
    session::SessionOptions session;
    session.max_baud = options.max_baud;
    return session;
}

link::StreamTarget stream_target(const Address& address, const Options& options) {
    if (address.kind == Address::Kind::kTcp) return link::TcpAddress{address.host, address.port};
    return link::SerialTarget{address.path, options.baud, link::DtrAtOpen::kRaise};
}

std::optional<Json> value_of(const protocol::Event& event, const model::ServiceModel* model,
                             const session::Identity& board) {
    if (model == nullptr) return std::nullopt;
    auto json = model::decode_event(*model, event, {&board.port_map, board.pin_modes});
    return json ? std::optional<Json>(std::move(*json)) : std::nullopt;
}

/// A decoded event; of a service without a model, or one that its model does not cover, what is on the wire.
Json decoded(const protocol::Event& event, const model::ServiceModel* model, const session::Identity& board) {
    auto value = value_of(event, model, board);
    return value ? std::move(*value) : model::raw_event(event);
}

Error error_of(const session::Finished& end) {
    using session::Ending;
    switch (end.ending) {
        case Ending::kBoardError:
            return {Error::Kind::kBoard, end.code, end.text};
        case Ending::kNotSent:
            return {Error::Kind::kUnreachable, 0,
                    end.not_sent == session::NotSent::kDeadline ? "the board was busy until it was too late"
                                                                : "the board went away before it was sent"};
        case Ending::kDoubt:
            return {Error::Kind::kTimeout, 0, bus::why_of(bus::Reply::timeout(bus::kTimeoutDoubt))};
        case Ending::kNoValue:
            return {Error::Kind::kTimeout, 0, bus::why_of(bus::Reply::timeout(bus::kTimeoutNoValue))};
        default:
            return {Error::Kind::kTimeout, 0, bus::why_of(bus::Reply::timeout())};
    }
}

Error error_of(session::Refusal refusal) {
    switch (refusal) {
        case session::Refusal::kInvalid:
            return {Error::Kind::kInvalid, 0, "not an ASIP request line"};
        case session::Refusal::kTooLong:
            return {Error::Kind::kInvalid, 0, "longer than the board takes; send it in parts"};
        case session::Refusal::kTooManyNames:
            return {Error::Kind::kRefused, 0, "the board was given a name too often: its memory wears out"};
        case session::Refusal::kQueueFull:
            return {Error::Kind::kRefused, 0, "too many requests wait for the board already"};
        default:
            return {Error::Kind::kUnreachable, 0, "the board does not answer now"};
    }
}

}  // namespace

DirectTransport::DirectTransport(boost::asio::io_context& io, Address address, Options options)
    : io_(io),
      address_(std::move(address)),
      options_(std::move(options)),
      session_(session_options(options_)),
      calls_(io.get_executor()),
      deadline_(io) {}

DirectTransport::~DirectTransport() {
    alive_.reset();
    close();
}

Awaitable<void> DirectTransport::open(Listener& listener) {
    listener_ = &listener;
    calls_.begin(kOpeningRequest);
    link_ = std::make_unique<link::KeptStream>(io_, stream_target(address_, options_),
                                               link::KeptStream::Handlers{
                                                   [this](const link::StreamOpened& link) { opened(link); },
                                                   [this](const link::StreamError& error) { lost(error); },
                                                   [this](std::string_view bytes) {
                                                       session::Actions actions;
                                                       session_.receive(bytes, Clock::now(), actions);
                                                       perform(actions);
                                                   },
                                                   [this](const link::StreamError& error) { failed(error); },
                                               });
    link_->start();
    const auto done =
        co_await calls_.wait(kOpeningRequest, options_.open_timeout, "no ASIP board answered in time");
    if (!done) co_return Unexpected<Error>(done.error());
    opened_ = true;
    co_return Result<void>();
}

Awaitable<Json> DirectTransport::command(std::string service, Json command) {
    const auto* known = services_.find(service);
    if (known == nullptr)
        co_return failure(Error::Kind::kInvalid, "the board has no service \"" + service + "\"");
    auto encoded = model::encode_control_json(known->model.get(), known->letter, command);
    if (!encoded) co_return failure(Error::Kind::kInvalid, encoded.error());
    co_return co_await request(std::move(encoded->line), encoded->answer, known->model);
}

Awaitable<void> DirectTransport::raw(std::string line) {
    const auto done = co_await request(std::move(line), 0, nullptr);
    co_return done ? Result<void>() : Result<void>(Unexpected<Error>(done.error()));
}

Awaitable<Json> DirectTransport::request(std::string line, char answer_tag, model::ModelPtr model) {
    session::Actions actions;
    const Time now = Clock::now();
    session::RequestOptions options{
        .deadline = now + options_.command_timeout, .prove = true, .answer_tag = answer_tag};
    if (model != nullptr && answer_tag != 0) {
        options.is_answer = [this, model](const protocol::Event& event) {
            return model->event(event.tag) == nullptr ||
                   value_of(event, model.get(), session_.identity()).has_value();
        };
    }
    const auto id = session_.submit(line, options, now, actions);
    if (!id) co_return Unexpected<Error>(error_of(id.error()));
    calls_.begin(*id);
    perform(actions);
    const auto answer =
        co_await calls_.wait(*id, options_.command_timeout, bus::why_of(bus::Reply::timeout()));
    if (!answer || !answer->is_string()) co_return answer;
    const auto message = protocol::parse_line(answer->get_ref<const std::string&>());
    const auto* const event = std::get_if<protocol::Event>(&message);
    co_return event == nullptr ? Json() : decoded(*event, model.get(), session_.identity());
}

std::string DirectTransport::board_name() const {
    if (!session_.identity().stored_name.empty()) return session_.identity().stored_name;
    return model::suggest_name(address_.kind == Address::Kind::kTcp
                                   ? address_.host + "-" + std::to_string(address_.port)
                                   : address_.path.substr(address_.path.rfind('/') + 1));
}

std::vector<ServiceInfo> DirectTransport::services() const {
    std::vector<ServiceInfo> infos;
    for (const auto& each : services_.entries())
        infos.push_back({each.name, each.letter, each.title});
    return infos;
}

void DirectTransport::close() {
    if (closed_) return;
    closed_ = true;
    deadline_.cancel();
    calls_.finish_all({Error::Kind::kClosed, 0, "the board was closed"});
    if (link_) {
        session::Actions actions;
        session_.leave(session::Leave::kAtOnce, Clock::now(), actions);
        for (const auto& action : actions)
            if (const auto* write = std::get_if<session::Write>(&action)) link_->write(write->bytes);
        link_->stop();
    }
}

// --- the link

void DirectTransport::opened(const link::StreamOpened& link) {
    session::Actions actions;
    session_.link_up({link.baud, link.restarting}, Clock::now(), actions);
    perform(actions);
}

void DirectTransport::lost(const link::StreamError& error) {
    const std::weak_ptr<bool> alive = alive_;  // a handler of the application may destroy this
    session::Actions actions;
    session_.link_down(Clock::now(), actions);
    perform(actions);
    if (alive.expired() || closed_) return;
    failed(error);
    set_presence(false);
}

void DirectTransport::failed(const link::StreamError& error) {
    if (!opened_) calls_.finish(kOpeningRequest, failure(Error::Kind::kUnreachable, error.text));
}

void DirectTransport::set_line_rate(unsigned baud) {
    link_->set_rate(baud, [this, alive = std::weak_ptr<bool>(alive_)](bool ok) {
        if (alive.expired() || closed_) return;
        session::Actions actions;
        session_.line_rate_set(ok, Clock::now(), actions);
        perform(actions);
    });
}

// --- what the session reports

void DirectTransport::perform(const session::Actions& actions) {
    const std::weak_ptr<bool> alive = alive_;
    for (const session::Action& action : actions) {
        perform_one(action);
        if (alive.expired() || closed_) return;
    }
    arm();
}

void DirectTransport::perform_one(const session::Action& action) {
    if (const auto* write = std::get_if<session::Write>(&action)) {
        link_->write(write->bytes);
    } else if (const auto* rate = std::get_if<session::SetLineRate>(&action)) {
        set_line_rate(rate->baud);
    } else if (const auto* line = std::get_if<session::BoardLine>(&action)) {
        deliver(line->line);
    } else if (const auto* end = std::get_if<session::Finished>(&action)) {
        finished(*end);
    } else if (std::holds_alternative<session::Identified>(action)) {
        identified();
    } else if (std::holds_alternative<session::BoardReset>(action) ||
               std::holds_alternative<session::BecameSilent>(action)) {
        set_presence(false);
    } else if (const auto* none = std::get_if<session::NoAnswer>(&action)) {
        calls_.finish(
            kOpeningRequest,
            failure(Error::Kind::kUnreachable,
                    none->heard_banner ? "the board said that it is there, and then answered nothing: is the "
                                         "line damaged, or is the board busy for seconds?"
                    : none->heard_bytes
                        ? "something answers, but not in ASIP: is the rate right, and does the board run an "
                          "ASIP sketch?"
                        : "nothing answers: is this the right port, and does the board run an ASIP sketch?"));
    }
}

void DirectTransport::deliver(const protocol::ParsedLine& line) {
    if (!line.is_event() || !there_) return;
    const protocol::Event event = line.event();
    if (const auto* known = services_.find(event.service))
        listener_->on_event(known->name, decoded(event, known->model.get(), session_.identity()));
}

void DirectTransport::identified() {
    services_ = session::ServiceTable(session_.identity(), model::ModelSet::standard());
    calls_.finish(kOpeningRequest, Json());
    set_presence(true);
}

void DirectTransport::finished(const session::Finished& end) {
    const bool done = end.ending == session::Ending::kExecuted || end.ending == session::Ending::kUnproven;
    if (!done)
        calls_.finish(end.id, Unexpected<Error>(error_of(end)));
    else
        calls_.finish(end.id, end.answer.empty() ? Json() : Json(end.answer.text()));
}

void DirectTransport::set_presence(bool there) {
    if (there != there_) {
        there_ = there;
        listener_->on_presence(there);
    }
}

void DirectTransport::arm() {
    const auto next = session_.next_deadline();
    if (!next || closed_) {
        deadline_.cancel();
        return;
    }
    if (deadline_.expiry() == *next && *next > Clock::now()) return;
    deadline_.expires_at(*next);
    deadline_.async_wait(
        [this, alive = std::weak_ptr<bool>(alive_)](const boost::system::error_code& cancelled) {
            if (cancelled || alive.expired() || closed_) return;
            session::Actions actions;
            session_.tick(Clock::now(), actions);
            perform(actions);
        });
}

}  // namespace asip::client
