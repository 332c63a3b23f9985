// SPDX-License-Identifier: Apache-2.0
#include "cli/secure/try_out.hpp"

#include <algorithm>
#include <boost/asio/io_context.hpp>
#include <map>
#include <set>

#include "asip/bus/request/request_envelope.hpp"
#include "asip/bus/topics.hpp"
#include "asip/mqtt/client.hpp"
#include "asip/random.hpp"

namespace asip::cli {
namespace {

using namespace std::chrono_literals;

/// A connection that counts what the broker allows.
class Attempt {
  public:
    Attempt(boost::asio::io_context& io, mqtt::Options options)
        : io_(io), client_(io, tuned(options), handlers()) {}

    mqtt::Client& client() { return client_; }

    bool run_until(const std::function<bool()>& done, Time end) {
        while (!done() && Clock::now() < end)
            io_.run_one_for(20ms);
        return done();
    }
    Outcome<void> connect(Time end) {
        client_.start();
        run_until([this] { return client_.subscribed() || given_up(); }, end);
        if (client_.subscribed()) return {};
        return failure(program::kExitBroker, failure_ ? failure_->text : "the broker does not answer");
    }
    bool refused() const {
        return failure_ && failure_->kind == mqtt::ConnectionFailure::Kind::kBadCredentials;
    }

    /// A refused message may cost the connection: one at a time, and none is lost.
    void publish(const std::string& topic, Time end) {
        client_.publish(mqtt::Message{.topic = topic, .qos = 1}, mqtt::Priority::kReply);
        run_until([&] { return allowed_.contains(topic) || denied_.contains(topic); }, end);
    }
    Found published(const std::vector<std::string>& topics) const { return found(topics, allowed_, denied_); }

    std::map<std::string, int> received;
    bool has(const std::string& topic) const { return received.contains(topic); }

    static Found found(const std::vector<std::string>& topics, const std::set<std::string>& yes,
                       const std::set<std::string>& no) {
        const auto all_in = [&](const auto& set) {
            return std::all_of(topics.begin(), topics.end(),
                               [&](const auto& one) { return set.contains(one); });
        };
        if (all_in(yes)) return Found::kAllowed;
        if (all_in(no)) return Found::kDenied;
        const bool known = std::all_of(topics.begin(), topics.end(), [&](const auto& one) {
            return yes.contains(one) || no.contains(one);
        });
        return known ? Found::kPartly : Found::kUnknown;
    }

  private:
    static mqtt::Options tuned(mqtt::Options options) {
        options.random = system_random();
        options.client_id = "asipctl-check-" + random_hex(options.random, 12);
        options.retry_max = 200ms;
        return options;
    }
    mqtt::Client::Handlers handlers() {
        mqtt::Client::Handlers result;
        result.on_connect_failed = [this](const mqtt::ConnectionFailure& why) { failure_ = why; };
        result.on_message = [this](const mqtt::Message& message) { ++received[message.topic]; };
        result.on_published = [this](const std::string& topic) { allowed_.insert(topic); };
        result.on_publish_denied = [this](const std::string& topic, const std::string&) {
            denied_.insert(topic);
        };
        return result;
    }
    bool given_up() const { return failure_ && (failure_->hopeless || failure_->fatal()); }

    boost::asio::io_context& io_;
    std::optional<mqtt::ConnectionFailure> failure_;
    std::set<std::string> allowed_, denied_;
    mqtt::Client client_;
};

/// What of `topics` reached the subject before the mark that came behind it did.
Found arrived(const Attempt& subject, const std::vector<std::string>& topics) {
    std::set<std::string> yes, no;
    for (const auto& topic : topics)
        (subject.has(topic) ? yes : no).insert(topic);
    return Attempt::found(topics, yes, no);
}

}  // namespace

Outcome<std::vector<Found>> try_out(const std::vector<Trial>& trials, const mqtt::Options& subject_options,
                                    const mqtt::Options& admin_options, const std::string& root,
                                    Duration limit) {
    const auto end = Clock::now() + limit;
    boost::asio::io_context io{1};
    Attempt admin(io, admin_options);
    if (auto connected = admin.connect(end); !connected) return tl::unexpected(connected.error());
    // Read and write in two connections: what the reader publishes itself would be its own.
    Attempt reader(io, subject_options);
    const auto mark =
        bus::ReplyTopics(bus::Topics(root), subject_options.user, "check-" + random_hex(system_random(), 12))
            .own();
    reader.client().subscribe(mark, {.qos = 1});
    for (const auto& trial : trials)
        for (const auto& topic : trial.reads)
            reader.client().subscribe(topic, {.qos = 1});
    if (auto connected = reader.connect(end); !connected) return tl::unexpected(connected.error());
    for (const auto& trial : trials)
        for (const auto& topic : trial.reads)
            admin.publish(topic, end);
    admin.publish(mark, end);
    const bool read = reader.run_until([&] { return reader.has(mark); }, end);

    Attempt writer(io, subject_options);
    if (auto connected = writer.connect(end); !connected) return tl::unexpected(connected.error());
    std::vector<Found> result;
    for (const auto& trial : trials) {
        for (const auto& topic : trial.publishes)
            writer.publish(topic, end);
        result.push_back(!trial.publishes.empty() ? writer.published(trial.publishes)
                         : read                   ? arrived(reader, trial.reads)
                                                  : Found::kUnknown);
    }
    return result;
}

Outcome<bool> accepts(mqtt::Options options, Duration limit) {
    boost::asio::io_context io{1};
    Attempt attempt(io, std::move(options));
    const auto connected = attempt.connect(Clock::now() + limit);
    if (connected) return true;
    if (attempt.refused()) return false;
    return tl::unexpected(connected.error());
}

Outcome<bool> is_open(mqtt::Options options, const std::string& root, const std::string& stranger,
                      Duration limit) {
    const auto end = Clock::now() + limit;
    options.user.clear();
    options.password.clear();
    boost::asio::io_context io{1};
    Attempt attempt(io, std::move(options));
    const auto connected = attempt.connect(end);
    if (!connected && attempt.refused()) return false;
    if (!connected) return tl::unexpected(connected.error());
    if (!attempt.client().v5()) return true;
    const auto topic = bus::Topics(root).board_in(stranger);
    attempt.publish(topic, end);
    return attempt.published({topic}) == Found::kAllowed;
}

}  // namespace asip::cli
