// SPDX-License-Identifier: Apache-2.0
#include "agent/application.hpp"

#include <boost/asio/post.hpp>
#include <utility>

#include "asip/program/exit_status.hpp"
#include "asip/program/log.hpp"
#include "asip/text/wall_time.hpp"

namespace asip::agent {

namespace log = program::log;

namespace {

constexpr Duration kGoodbye = std::chrono::milliseconds(700);
// Longer than a boot loader and two rounds of asking at the start rate.
constexpr Duration kSilentAtStart = std::chrono::milliseconds(3500);
// What is held is undone before the goodbye; a board that does not answer is not waited for longer.
constexpr Duration kMakeSafe = std::chrono::milliseconds(500);
constexpr Duration kLookAgain = std::chrono::milliseconds(5);

link::StreamTarget stream_target(const AgentOptions& options) {
    if (options.serial.empty()) return *link::parse_tcp_address(options.tcp);
    const auto dtr =
        options.reset == ResetPolicy::kAlways ? link::DtrAtOpen::kPulse : link::DtrAtOpen::kLeave;
    return link::SerialTarget{options.serial, options.baud, dtr};
}

BridgeOptions bridge_options(BridgeOptions options, const LabelFiles& files) {
    options.load_labels = [&files](const std::string& board) { return files.load(board); };
    return options;
}

}  // namespace

Application::Application(AgentOptions options)
    : options_(std::move(options)),
      topics_(options_.bridge.topic_root),
      label_files_(options_.state_folder),
      bridge_(bridge_options(options_.bridge, label_files_), options_.models, system_random()),
      link_(io_, stream_target(options_),
            {[this](const link::StreamOpened& opened) { link_opened(opened); },
             [this](const link::StreamError& error) { link_lost(error); },
             [this](std::string_view bytes) {
                 board_heard();
                 with_bridge([&](Time now, Effects& out) { bridge_.receive(bytes, now, out); });
             },
             [this](const link::StreamError& error) {
                 link_failed(error, !std::exchange(link_tried_, true));
             }}),
      clients_(io_, options_.listen_silence,
               [this](session::ClientId client, std::string_view line) {
                   auto result = Bridge::ClientResult::kAccepted;
                   with_bridge([&](Time now, Effects& out) {
                       result = bridge_.client_line(client, line, now, out);
                       if (result == Bridge::ClientResult::kRefused)
                           log::debug("client's line refused", {{"line", line}});
                   });
                   return result != Bridge::ClientResult::kLater;
               }),
      stop_signal_(io_, [this](int) { stop(); }),
      timer_(io_),
      reset_timer_(io_),
      counters_timer_(io_),
      statistics_timer_(io_),
      safe_timer_(io_) {}

Application::~Application() {
    log::observe(log::Level::kOff, {});
}

int Application::run() {
    for (const auto& [address, framing] : options_.listen) {
        const auto port = clients_.listen(address, framing);
        if (!port) {
            log::error("cannot listen for clients", {{"why", port.error().text}});
            return program::kExitFailure;
        }
        log::info("listening for clients", {{"port", *port}});
    }
    link_.start();
    report_counters();
    log::observe(log::Level::kInfo,
                 [this](log::Level level, std::string_view text, std::span<const log::Field> fields) {
                     log_feed_.add(level, text, fields, text::iso_time(text::wall_now()), Clock::now());
                     if (!stopping_) publish_log();
                 });
    // Agents that start together do not publish together.
    if (options_.statistics > Duration{})
        publish_statistics(std::chrono::duration_cast<Duration>(options_.statistics *
                                                                (.5 + random_unit(system_random()) / 2)));
    io_.run();
    return status_;
}

void Application::perform(Effects& effects) {
    for (const auto& notice : effects.notices) {
        std::vector<log::Field> fields;
        if (!bridge_.name().empty()) fields.emplace_back("board", bridge_.name());
        for (const auto& [name, value] : notice.fields)
            if (!value.empty() && name != "board") fields.emplace_back(name, value);
        log::write(notice.level, notice.text, fields);
    }
    for (auto& action : effects.link) {
        if (const auto* write = std::get_if<session::Write>(&action)) {
            link_.write(write->bytes);
        } else if (const auto* rate = std::get_if<session::SetLineRate>(&action)) {
            link_.set_rate(rate->baud, [this](bool ok) {
                with_bridge([&](Time now, Effects& out) { bridge_.line_rate_set(ok, now, out); });
            });
        }
    }
    if (effects.board_known) {
        board_ever_known_ = true;
        reset_timer_.cancel();
        if (!bus_) connect_bus();
    }
    if (bus_ && effects.name_claimed) subscribe_to_commands();
    if (bus_)
        for (auto& publication : effects.publish)
            bus_->publish(std::move(publication.message), publication.priority);
    for (const auto& [line, client] : effects.lines)
        clients_.send(line, client);
    if (effects.name_claimed) publish_log();
    if (effects.keep_labels) keep_labels(std::move(*effects.keep_labels));
    if (effects.reopen_link) link_.reopen("the board does not answer");
    if (effects.port == Effects::Port::kLetGo) {
        reset_timer_.cancel();
        link_.stop();
    }
    if (effects.port == Effects::Port::kTakeBack) link_.start();
    if (effects.fatal) {
        if (!stop_asked_) log::error(effects.fatal->text, {});
        end_once_safe([this, status = effects.fatal->status] { finish(status); });
    }
}

void Application::keep_labels(LabelsToKeep keep) {
    if (!disk_) disk_.emplace(1);
    boost::asio::post(*disk_, [this, board = bridge_.name(), keep = std::move(keep)] {
        boost::asio::post(io_, [this, result = label_files_.save(board, keep)] {
            with_bridge([&](Time, Effects& out) { bridge_.labels_kept(result, out); });
        });
    });
}

void Application::arm_timer() {
    const auto deadline = bridge_.next_deadline();
    if (!deadline) {
        armed_for_.reset();
        timer_.cancel();
        return;
    }
    // Deadlines move later with every line that arrives; the timer is then left to fire early once.
    if (armed_for_ && *armed_for_ <= *deadline) return;
    armed_for_ = *deadline;
    timer_.expires_at(*deadline);
    timer_.async_wait([this](boost::system::error_code error) {
        if (error || stopping_) return;
        held_up_.runs(Clock::now(), std::exchange(armed_for_, std::nullopt));
        with_bridge([&](Time now, Effects& out) {
            if (const auto due = bridge_.next_deadline(); due && *due <= now) bridge_.tick(now, out);
        });
    });
}

void Application::link_opened(const link::StreamOpened& opened) {
    link_tried_ = true;
    model::LinkInfo info{options_.serial.empty() ? "tcp" : "serial", opened.name,
                         static_cast<int>(opened.baud)};
    with_bridge([&](Time now, Effects& out) {
        bridge_.link_up({opened.baud, opened.restarting}, std::move(info), now, out);
    });
    if (!opened.restarting && options_.reset == ResetPolicy::kIfSilent) board_silent_at_start();
}

void Application::link_failed(const link::StreamError& error, bool first) {
    using Kind = link::StreamError::Kind;
    const bool waiting_helps =
        error.kind == Kind::kNotThere || error.kind == Kind::kUnreachable || error.kind == Kind::kClosed;
    if (first && !waiting_helps) {
        log::error(error.text, {});
        return finish(program::kExitBoard);
    }
    if (outage_.failed(error.kind, Clock::now()))
        log::warning("board not reachable; waiting for it", {{"why", error.text}});
}

void Application::link_lost(const link::StreamError& error) {
    reset_timer_.cancel();
    // Opened and closed without a byte from the board: the same as not opened.
    if (bridge_.session().counters().bytes_in == 0) link_failed(error, false);
    with_bridge([&](Time now, Effects& out) { bridge_.link_down(error.text, now, out); });
}

void Application::board_heard() {
    if (!stopping_ && outage_.heard()) log::info("board reachable again", {});
}

void Application::board_silent_at_start() {
    reset_timer_.expires_after(kSilentAtStart);
    reset_timer_.async_wait([this](boost::system::error_code error) {
        if (error || stopping_ || bridge_.session().state() == session::BoardSession::State::kReady) return;
        if (link_.restart_board()) log::info("board silent; restarting it by DTR", {});
    });
}

void Application::stop() {
    if (stopping_ || stop_asked_) return;
    log::info("stopping", {});
    end_once_safe([this] {
        Effects effects;
        bridge_.goodbye(Clock::now(), effects);
        effects.link.clear();
        perform(effects);
        finish(program::kExitOk);
    });
}

void Application::end_once_safe(std::function<void()> end) {
    if (stopping_ || std::exchange(stop_asked_, true)) return;
    with_bridge([&](Time now, Effects& out) { bridge_.release_holds(now, out); });
    wait_until_safe(Clock::now() + kMakeSafe, std::move(end));
}

void Application::wait_until_safe(Time limit, std::function<void()> end) {
    if (stopping_) return;
    if (bridge_.is_safe() || !bridge_.session().accepts_requests() || Clock::now() >= limit) return end();
    safe_timer_.expires_after(kLookAgain);
    safe_timer_.async_wait([this, limit, end = std::move(end)](boost::system::error_code error) mutable {
        if (!error) wait_until_safe(limit, std::move(end));
    });
}

void Application::finish(int status) {
    if (std::exchange(stopping_, true)) return;
    status_ = status;
    timer_.cancel();
    reset_timer_.cancel();
    counters_timer_.cancel();
    statistics_timer_.cancel();
    safe_timer_.cancel();
    clients_.close();
    link_.stop();
    if (!bus_) {
        stop_signal_.cancel();
        io_.stop();
        return;
    }
    bus_->stop(kGoodbye, [this] {
        stop_signal_.cancel();
        io_.stop();
    });
}

}  // namespace asip::agent
