// SPDX-License-Identifier: Apache-2.0
#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <iostream>

#include "asip/program/exit_status.hpp"
#include "gateway/running_exports.hpp"

namespace asip::gateway {
namespace {

constexpr Duration kCleanTick = std::chrono::milliseconds(100);
constexpr Duration kUntilRetained = std::chrono::seconds(2);  // has come
constexpr Duration kCleanLimit = std::chrono::seconds(60);
constexpr Duration kCleanEnd = std::chrono::seconds(5);

/// A program that does nothing but clear.
class Cleaner {
  public:
    Cleaner(const exports::MakeExport& make, const mqtt::Options& mqtt)
        : connection_(io_, mqtt),
          export_(make(system_random(), port())),
          client_(io_, mqtt, handlers()),
          timer_(io_) {}

    int run() {
        for (const auto& filter : export_->subscriptions())
            client_.subscribe(filter);
        client_.start();
        until_ = Clock::now() + kCleanLimit;
        schedule();
        io_.run();
        return status_;
    }

  private:
    exports::Export::Port port() {
        auto port = connection_.port([this]() -> exports::Export& { return *export_; });
        port.ready = [this] { return subscribed_at_.has_value(); };
        port.boards = [] { return std::vector<std::string>(); };
        port.board = [](const std::string&) { return std::nullopt; };
        port.value = [](const auto&, const auto&) { return std::nullopt; };
        port.refused = [](std::uint64_t) {};
        port.want = [](const std::string&, const std::string&, double) { return nullptr; };
        port.command = [](const std::string&, const property::Request&, const auto&) {};
        port.log = [](const std::string&) {};
        port.wall_ms = [] { return std::int64_t{0}; };  // nothing is said that has a date
        return port;
    }
    mqtt::Client::Handlers handlers() {
        mqtt::Client::Handlers result;
        result.on_subscribed = [this] {
            subscribed_at_ = Clock::now();
            export_->subscribed(*subscribed_at_);
        };
        result.on_message = [this](const mqtt::Message& message) { export_->message(message, Clock::now()); };
        result.on_connect_failed = [this](const mqtt::ConnectionFailure& failure) {
            end(program::kExitBroker, failure.text);
        };
        return result;
    }
    void schedule() {
        timer_.expires_after(kCleanTick);
        timer_.async_wait([this](const boost::system::error_code& error) {
            if (!error) tick();
        });
    }
    void tick() {
        const auto now = Clock::now();
        if (export_->finished()) return end(program::kExitOk, "nothing of the export is left on the broker");
        const auto& holder = export_->turn().holder();
        if (subscribed_at_ && now - *subscribed_at_ > exports::Turn::kStale + kUntilRetained && holder &&
            export_->turn().held(now))
            return end(program::kExitFailure,
                       "a gateway on " + holder->host +
                           " exports now; stop it, or start it without the option, first");
        if (now >= until_) return end(program::kExitFailure, "the broker did not answer in time");
        export_->tick(now);
        schedule();
    }
    void end(int status, const std::string& sentence) {
        if (ended_) return;
        ended_ = true;
        status_ = status;
        timer_.cancel();
        connection_.stop(kCleanEnd, [this, sentence] {
            (status_ == program::kExitOk ? std::cout : std::cerr)
                << "asip-gateway: " << export_->title() << ": " << sentence << std::endl;
            client_.stop(kCleanEnd, [this] { io_.stop(); });
        });
    }

    boost::asio::io_context io_{1};
    ExportConnection connection_;
    std::unique_ptr<exports::Export> export_;
    mqtt::Client client_;
    boost::asio::steady_timer timer_;
    std::optional<Time> subscribed_at_;
    Time until_{};
    int status_ = 0;
    bool ended_ = false;
};

}  // namespace

int clean_exports(const std::vector<exports::MakeExport>& exports, const mqtt::Options& mqtt) {
    int worst = program::kExitOk;
    for (const auto& each : exports)
        if (const int status = Cleaner(each, mqtt).run(); status != program::kExitOk) worst = status;
    return worst;
}

}  // namespace asip::gateway
