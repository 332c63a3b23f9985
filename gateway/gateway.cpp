// SPDX-License-Identifier: Apache-2.0
#include "gateway/gateway.hpp"

#include <utility>

#include "asip/program/log.hpp"
#include "asip/text/printable.hpp"
#include "gateway/api/routes.hpp"
#include "gateway/stream/value_feed.hpp"

namespace asip::gateway {
namespace {

constexpr Duration kRegistryTime = std::chrono::seconds(3);
constexpr std::size_t kMaxRequestShown = 200;
constexpr std::size_t kMaxToLog = 64;
constexpr std::size_t kBytesOfQuestion = 16 * 1024;  // to a registry, with what its answer needs at least

// A command and its sender. A renewal is a sign of life, many times a second.
void log_command(const CommandRecord& record) {
    if (record.renewal || record.of_many) return;
    const auto& reply = *record.reply;
    program::log::info("command", {{"by", record.by},
                                   {"target", record.target},
                                   {"request", text::printable(record.request, kMaxRequestShown)},
                                   {"status", bus::to_string(reply.status)},
                                   {"reason", reply.reason},
                                   {"late", record.late}});
}

Mirror::Options mirror_options(const GatewayOptions& options, catalogue::UnitsOf units_of) {
    Mirror::Options result;
    result.topic_root = options.topic_root;
    result.forget_after = options.forget_after;
    result.values = options.values;
    result.units_of = std::move(units_of);
    result.own_topic = options.replies().below("mark").own();
    return result;
}

}  // namespace

/// A client that waits for the next value of a service.
struct Gateway::Wait final : OpenStream {
    Wait(Gateway& gateway, const http::Reply& to, Principal principal, std::string client)
        : OpenStream(std::move(principal), std::move(client)), streams(gateway.streams_), reply(to) {
        streams.add(*this);
    }
    ~Wait() override { streams.remove(*this); }
    void tick(const Instant&) override {}
    void revoke() override { revoked = true; }

    Streams& streams;
    http::Reply reply;
    Budget::Part part;
    std::unique_ptr<Feed> feed;
    std::function<void(bool revoked)> done;
    Time until{};
    bool ready = false;
    bool revoked = false;
};

Gateway::Gateway(GatewayOptions options, model::ModelSet models, catalogue::UnitsOf units_of, Random random,
                 Secrets secrets, Port port)
    : options_(std::move(options)),
      port_(std::move(port)),
      models_(std::move(models)),
      caller_({.topics = bus::Topics(options_.topic_root),
               .user = options_.user,
               .name = options_.client,
               .role = "gateway"},
              random, port_.calls),
      mirror_(mirror_options(options_, std::move(units_of)), random,
              {[this](mqtt::Message message) { port_.publish(std::move(message)); }, port_.subscribe,
               port_.unsubscribe}),
      dashboards_(options_.topic_root,
                  {[this](mqtt::Message message) { return port_.publish(std::move(message)); },
                   [this] { mirror_.log().add("dashboards", {}, "{}"); },
                   [](const std::string& sentence) { program::log::warning(sentence); }}),
      commands_(caller_),
      gate_(options_.gate, secrets),
      budget_(options_.client_bytes),
      streams_(options_.streams_per_client),
      command_rates_(options_.commands_per_second),
      log_rates_(options_.commands_per_second) {
    gate_.set_shared({[this](std::string_view hash) { return dashboards_.link_of(hash); },
                      [this](const Rights& rights) { return dashboards_.holds(rights); },
                      [this](const std::string& name) {
                          return !dashboards_.known() || dashboards_.find(name) != nullptr;
                      },
                      [this] { return dashboards_.known(); }});
    commands_.on_finished = [this](const CommandRecord& record, Duration time) { finished(record, time); };
    commands_.before_again = [this] { log_commands(); };
}

Gateway::~Gateway() {
    log_commands();
}

// A log takes as long as the answer did: a client that waits for that may wait for the same processor.
void Gateway::finished(const CommandRecord& record, Duration time) {
    if (!record.late) durations_.add(std::chrono::duration<double>(time).count());
    to_log_.push_back(&record);
    // A timeout may become a late answer: then its record is another one.
    if (record.reply->status == bus::Reply::Status::kTimeout || to_log_.size() >= kMaxToLog)
        return log_commands();
    if (to_log_.size() == 1) port_.soon([this] { log_commands(); });
}

void Gateway::log_commands() {
    for (const auto* record : std::exchange(to_log_, {}))
        log_command(*record);
}

void Gateway::request(const http::Request& request, const http::Reply& reply) {
    api::serve(*this, request, reply);
}

http::Asker Gateway::asker_of(const http::Request& request) {
    return api::asker_of(*this, request);
}

const std::string& Gateway::openapi() {
    if (openapi_.empty()) openapi_ = api::openapi_document(api::routes(), options_.base_path);
    return openapi_;
}

std::vector<std::pair<std::string, bool>> Gateway::subscriptions() const {
    auto all = mirror_.subscriptions();
    all.emplace_back(dashboards_.subscription(), true);
    return all;
}

// All that is retained comes ahead of the mirror's own message.
void Gateway::read_dashboards() {
    if (!mirror_.reading()) dashboards_.complete();
}

void Gateway::subscribed() {
    dashboards_.subscribed();
    mirror_.subscribed(now());
}

void Gateway::disconnected() {
    mirror_.disconnected(now());
    dashboards_.disconnected();
}

void Gateway::leave() {
    caller_.leave();
    auto unknown = bus::Reply::timeout(bus::kTimeoutNoAnswer);
    unknown.error = "the gateway ended before the answer";
    caller_.end_all(unknown);
    for (auto& question : questions_)
        if (const auto done = std::exchange(question.done, {})) done(nullptr);
    for (auto& wait : std::exchange(waits_, {}))
        wait->done(false);
}

bool Gateway::answer(const mqtt::Message& message) {
    return caller_.message(message, now().time);
}

void Gateway::message(const mqtt::Message& message) {
    if (answer(message) || dashboards_.take(message)) return;
    mirror_.message(message, now());
    read_dashboards();
    if (wait_ready_) finish_waits(false);
}

void Gateway::tick() {
    const auto present = now();
    mirror_.tick(present);
    read_dashboards();
    dashboards_.tick(present.time);
    caller_.tick(present.time);
    commands_.tick(present.time);
    many_boards_.tick(present.time);
    gate_.lessons(present);
    streams_.tick(present, gate_);
    gate_.logins().expire(present.time);
    command_rates_.expire(present.time);
    log_rates_.expire(present.time);
    budget_.expire();
    finish_waits(true);
    for (auto each = questions_.begin(); each != questions_.end();) {
        if (!each->done || each->until <= present.time) {
            const auto done = std::move(each->done);
            each = questions_.erase(each);
            if (done) done(nullptr);
        } else {
            ++each;
        }
    }
}

void Gateway::command(Commands::Start start, Commands::Done done) {
    const auto refused = [&](std::string reason, std::string error) {
        CommandRecord record{start.id, start.by, start.target,  start.payload, now(),
                             {},       false,    start.renewal, start.of_many};
        record.reply = bus::Reply::refused(std::move(reason), std::move(error));
        record.reply->id = start.id;
        record.reply->by = start.by;
        done(record);
    };
    // A stop of many boards is many commands: none of them is refused, and no later one because of them.
    // Their number has a bound.
    if (!start.urgent) start.part = budget_.part(start.client);
    if (!start.part.set(Commands::bytes_of(start))) {
        return refused(std::string(bus::kRefusedQueueFull),
                       "what is kept of your commands would be too much; it is kept for a minute");
    }
    start.answer_first = start.urgent && port_.urgent_ready();
    switch (commands_.start(start, now(), done)) {
        case Commands::Started::kSent:
        case Commands::Started::kRepeated:
            break;
        case Commands::Started::kIdReused:
            refused(std::string(bus::kRefusedIdReused), "another command had this id within the last minute");
            break;
        case Commands::Started::kTooMany:
            refused(std::string(bus::kRefusedQueueFull), "too many commands are under way");
            break;
    }
}

bool Gateway::ask_registry(const std::string& payload, const std::string& client, Answered done,
                           std::string topic) {
    auto part = budget_.part(client);
    if (!part.set(kBytesOfQuestion)) return false;
    mqtt::Message message;
    message.topic = topic.empty() ? mirror_.topics().any_registry_query() : std::move(topic);
    message.payload = payload;
    message.qos = 1;
    auto& question = questions_.emplace_back();
    question.done = std::move(done);
    question.until = now().time + kRegistryTime;
    question.part = std::move(part);
    const auto answered = [&question](const mqtt::Message& received) {
        const auto answer = bus::parse_answer(received.payload);
        if (!answer || !question.done) return;
        std::exchange(question.done, {})(&*answer);
    };
    question.request = caller_.ask(std::move(message), answered, now().time);
    if (question.request.id().empty()) question.until = now().time;
    return true;
}

void Gateway::wait_for_value(std::unique_ptr<Feed> feed, Duration limit, const http::Reply& reply,
                             const Principal& principal, const std::string& client,
                             std::function<void(bool revoked)> done) {
    auto& wait = waits_.emplace_back(std::make_unique<Wait>(*this, reply, principal, client));
    wait->feed = std::move(feed);
    wait->done = std::move(done);
    wait->until = now().time + limit;
    // Not finished from inside the wake: it comes while the values call their feeds.
    wait->feed->wake = [this, waiting = wait.get()] { waiting->ready = wait_ready_ = true; };
}

// `all`: also those that no client waits for any more, or whose time or right is over.
void Gateway::finish_waits(bool all) {
    wait_ready_ = false;
    const auto time = now().time;
    for (auto each = waits_.begin(); each != waits_.end();) {
        auto& wait = **each;
        const bool gone = all && wait.reply.gone();
        if (!wait.ready && !gone && (!all || (!wait.revoked && wait.until > time))) {
            ++each;
            continue;
        }
        const auto over = std::move(*each);
        each = waits_.erase(each);
        if (!gone) over->done(over->revoked);
    }
}

}  // namespace asip::gateway
