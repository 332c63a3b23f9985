// SPDX-License-Identifier: Apache-2.0
#include "bench/load/application.hpp"

#include <boost/asio/post.hpp>
#include <iostream>
#include <nlohmann/json.hpp>

#include "asip/program/exit_status.hpp"
#include "asip/program/log.hpp"

namespace asip::load {

namespace log = program::log;

namespace {

constexpr Duration kGoodbye = std::chrono::seconds(5);
constexpr auto kProgress = std::chrono::seconds(10);
constexpr auto kAnswersTick = std::chrono::milliseconds(10);

}  // namespace

Application::Application(LoadOptions options)
    : options_(std::move(options)),
      fleet_(io_, options_.fleet, options_.kind, system_random()),
      plan_(options_.steps, options_.fleet.boards),
      stop_signal_(io_, [this](int) { stop(); }),
      steps_timer_(io_),
      progress_timer_(io_),
      answers_timer_(io_) {
    const auto& fleet = options_.fleet;
    fleet_.on_hopeless = [this](const std::string& why) { hopeless(why); };
    if (options_.watch) watch_.emplace(io_, fleet.mqtt, fleet.topic_root, fleet.prefix, fleet_);
    if (options_.commands_per_second > 0)
        commander_.emplace(io_, fleet.mqtt, fleet.topic_root, options_.kind, fleet_,
                           options_.commands_per_second);
    if (options_.queries_per_second > 0)
        queries_.emplace(io_, fleet.mqtt, fleet.topic_root, options_.kind, fleet_,
                         options_.queries_per_second);
    if (options_.watchers > 0)
        watchers_.emplace(io_, fleet.mqtt, fleet.topic_root, options_.watchers, fleet_);
}

int Application::run() {
    log::info("boards join", {{"boards", fleet_.size()},
                              {"boards per connection", options_.fleet.per_connection},
                              {"broker", options_.fleet.mqtt.brokers.front().describe()}});
    if (watch_) watch_->start();
    if (commander_) commander_->start();
    if (queries_) queries_->start();
    if (watchers_) watchers_->start();
    started_ = Clock::now();
    schedule_steps();
    schedule_progress();
    io_.run();
    return print();
}

void Application::schedule_steps() {
    const Duration now = Clock::now() - started_;
    for (const auto& due : plan_.due(now, fleet_.settled()))
        fleet_.perform(due);
    auto next = plan_.next(now);
    if (options_.time && (!next || *options_.time < *next)) next = options_.time;
    if (options_.time && now >= *options_.time) return stop();
    if (!next) return;
    steps_timer_.expires_at(started_ + *next);
    steps_timer_.async_wait([this](const boost::system::error_code& error) {
        if (!error && !stopping_) schedule_steps();
    });
}

void Application::schedule_progress() {
    progress_timer_.expires_after(kProgress);
    progress_timer_.async_wait([this](const boost::system::error_code& error) {
        if (error || stopping_) return;
        const auto tally = fleet_.tally();
        log::info("running", {{"present", fleet_.present()},
                              {"announced", fleet_.announced()},
                              {"descriptions", tally.descriptions},
                              {"commands", tally.commands}});
        schedule_progress();
    });
}

void Application::hopeless(const std::string& why) {
    if (stopping_ || std::exchange(no_broker_, true)) return;
    log::error(why, {});
    boost::asio::post(io_, [this] { stop(); });
}

void Application::stop() {
    if (std::exchange(stopping_, true)) return;
    steps_timer_.cancel();
    progress_timer_.cancel();
    if (commander_) commander_->stop();
    if (queries_) queries_->stop();
    report_.seconds = std::chrono::duration<double>(Clock::now() - started_).count();
    report_.tally = fleet_.tally();
    if (no_broker_) return finish();
    await_answers(Clock::now() + options_.settle);
}

/// `until`: for how long boards that lost their connection may announce again, where registries are compared.
void Application::await_answers(Time until) {
    const Time now = Clock::now();
    const bool commanded = !commander_ || commander_->idle(now);
    const bool announced = !watch_ || fleet_.announced() == fleet_.present() || now >= until;
    if (commanded && announced && (!queries_ || queries_->idle(now))) return compare();
    answers_timer_.expires_after(kAnswersTick);
    answers_timer_.async_wait([this, until](const boost::system::error_code&) { await_answers(until); });
}

void Application::compare() {
    if (!watch_) return finish();
    watch_->compare(options_.settle, [this] { compared(); });
}

void Application::compared() {
    report_.watched = true;
    report_.registries = watch_->registries();
    finish();
}

void Application::finish() {
    report_.boards = fleet_.size();
    report_.connections = (fleet_.size() + options_.fleet.per_connection - 1) / options_.fleet.per_connection;
    report_.present = fleet_.present();
    report_.announced = fleet_.announced();
    if (commander_) report_.commands = commander_->tally();
    if (queries_) report_.queries = queries_->tally();
    if (watchers_) {
        report_.watchers = watchers_->tally();
        watchers_->stop();
    }
    report_.usage = program::process_usage();
    fleet_.end(no_broker_ ? Duration{} : kGoodbye, [this] {
        stop_signal_.cancel();
        io_.stop();
    });
}

int Application::print() {
    if (options_.json)
        std::cout << to_json(report_).dump(2) << "\n";
    else
        std::cout << to_table(report_);
    std::cout.flush();
    if (no_broker_ || report_.tally.connections_made == 0) return program::kExitBroker;
    if (report_.tally.conflicts > 0) return program::kExitNameConflict;
    return report_.good() && std::cout ? program::kExitOk : program::kExitFailure;
}

}  // namespace asip::load
