// SPDX-License-Identifier: Apache-2.0
#include "agent/program/board_agent.hpp"

#include <boost/asio/post.hpp>
#include <utility>

#include "asip/link/usb_port.hpp"
#include "asip/program/exit_status.hpp"
#include "asip/program/log.hpp"

namespace asip::agent {

namespace log = program::log;

namespace {

constexpr Duration kGoodbye = std::chrono::milliseconds(700);
// Commands with a hold are undone before the goodbye. A board that does not answer is not waited for longer.
constexpr Duration kMakeSafe = std::chrono::milliseconds(500);
constexpr Duration kLeaveLine = std::chrono::milliseconds(400);
constexpr Duration kLookAgain = std::chrono::milliseconds(5);

link::StreamTarget stream_target(const AgentOptions& options) {
    if (options.serial.empty()) return options.tcp_address.address;
    const auto dtr =
        options.reset == ResetPolicy::kAlways ? link::DtrAtOpen::kPulse : link::DtrAtOpen::kLeave;
    return link::SerialTarget{options.serial, options.baud, dtr};
}

std::optional<std::pair<std::string, std::string>> called(bool several, const AgentOptions& options) {
    if (!several) return std::nullopt;
    if (!options.bridge.name.empty()) return std::pair{"board", options.bridge.name};
    return std::pair{"port", options.serial.empty() ? options.tcp : options.serial};
}

BridgeOptions bridge_options(BridgeOptions options, const LabelFiles& files, const StopFiles& stops,
                             const LinkFiles& links, const std::string& user, const std::string& firmware,
                             bool goes_on) {
    options.load_links = [&links](const std::string& board) { return links.load(board); };
    options.bus_user = user;
    options.announce_unreached = goes_on;
    options.load_labels = [&files](const std::string& board) { return files.load(board); };
    options.load_stop = [&stops](const std::string& board) { return stops.load(board); };
    options.loadable_version = [&firmware](const std::string& sketch, const std::string& chip) {
        return loadable_version(firmware, sketch, chip);
    };
    return options;
}

}  // namespace

BoardAgent::BoardAgent(const Host& host, AgentOptions options, Handlers handlers)
    : options_(std::move(options)),
      topics_(options_.bridge.topic_root),
      label_files_(options_.state_folder),
      stop_files_(options_.state_folder),
      link_files_(options_.state_folder),
      host_(host),
      handlers_(std::move(handlers)),
      io_(host.io),
      log_(called(host.several, options_),
           [this] {
               if (!ended()) publish_log();
           }),
      reports_(log_,
               [this] {
                   return BrokerReports::Agent{bridge_.name(), options_.bridge.topic_root, options_.mqtt.user,
                                               options_.mqtt.brokers.front().describe()};
               }),
      bridge_(bridge_options(options_.bridge, label_files_, stop_files_, link_files_, options_.mqtt.user,
                             options_.firmware_folder, host.goes_on),
              options_.models, system_random()),
      framing_(options_.tcp_address.framing, options_.tcp_address.address.port == PointToPoint::kJavaPort
                                                 ? LinkFraming::Kind::kFrames
                                                 : LinkFraming::Kind::kLines),
      link_(io_, stream_target(options_),
            {[this](const link::StreamOpened& opened) { link_opened(opened); },
             [this](const link::StreamError& error) { link_lost(error); },
             [this](std::string_view bytes) { link_received(bytes); },
             [this](const link::StreamError& error) { link_failed(error); }}),
      clients_(
          io_, log_, options_.listen_silence,
          [this] {
              note_running();
              return reads_since_;
          },
          [this](session::ClientId client, std::string_view line, std::optional<Time> sent) {
              auto result = Bridge::ClientResult::kAccepted;
              with_bridge([&](Time now, Effects& out) {
                  result = bridge_.client_line(client, line, sent, now, out);
                  if (result == Bridge::ClientResult::kRefused)
                      log_.debug("client's line refused", {{"line", line}});
              });
              return result != Bridge::ClientResult::kLater;
          }),
      timer_(io_),
      reset_timer_(io_),
      counters_timer_(io_),
      statistics_timer_(io_),
      safe_timer_(io_),
      check_timer_(io_),
      stops_timer_(io_),
      shares_(bus::Shares::processor_time, [this] { share_turn(); }),
      source_shares_(
          shares_, [this](const mqtt::Message& message) { hear_source(message); }, [](const std::string&) {}),
      demand_shares_(
          shares_,
          [this](const mqtt::Message& message) {
              if (const auto demand = bridge_.read(message, Clock::now())) take(*demand);
          },
          [](const std::string&) {}) {
    host_.agents.insert(this);
}

void BoardAgent::start() {
    for (const auto& [address, framing] : options_.listen) {
        const auto port = clients_.listen(address, framing);
        if (!port) {
            log_.error("cannot listen for clients", {{"why", port.error().text}});
            return finish(program::kExitFailure);
        }
        log_.info("listening for clients", {{"port", *port}});
    }
    link_.start();
    report_counters();
    // Agents that start together do not publish together.
    if (options_.statistics > Duration{})
        publish_statistics(std::chrono::duration_cast<Duration>(options_.statistics *
                                                                (.5 + random_unit(system_random()) / 2)));
}

void BoardAgent::note_online() {
    using State = session::BoardSession::State;
    const bool usable = hears_stops_ && bridge_.may_publish() && bridge_.session().state() == State::kReady;
    const auto now = usable ? Presence::kOnline : Presence::kAway;
    if (std::exchange(presence_, now) != now) handlers_.on_changed();
}

void BoardAgent::write(const std::vector<session::Action>& actions) {
    for (const auto& action : actions) {
        if (const auto* write = std::get_if<session::Write>(&action)) {
            link_.write(framing_.outgoing(write->bytes));
        } else if (const auto* rate = std::get_if<session::SetLineRate>(&action)) {
            link_.set_rate(rate->baud, [this](bool ok) {
                with_bridge([&](Time now, Effects& out) { bridge_.line_rate_set(ok, now, out); });
            });
        }
    }
}

void BoardAgent::perform(Effects& effects) {
    for (const auto& notice : effects.notices) {
        std::vector<log::Field> fields;
        if (!bridge_.name().empty()) fields.emplace_back("board", bridge_.name());
        for (const auto& [name, value] : notice.fields)
            if (!value.empty() && name != "board") fields.emplace_back(name, value);
        log_.write(notice.level, notice.text, fields);
    }
    if (effects.stopped) with_bridge([&](Time now, Effects& out) { bridge_.refuse_waiting(now, out); });
    // Before its answer leaves: the program that asked for the port opens it at once.
    if (effects.port == Effects::Port::kLetGo) {
        reset_timer_.cancel();
        link_.stop();
    }
    if (effects.load) load(std::move(*effects.load));
    if (effects.board_known) {
        log_.board_is(bridge_.name());
        reset_timer_.cancel();
        if (!bus_) connect_bus();
    }
    if (bus_ && effects.name_claimed) subscribe_to_commands();
    if (options_.mqtt.has_user()) drop_stray_answers(effects);
    publish(effects);
    for (const auto& [line, client] : effects.lines)
        clients_.send(line, client);
    if (effects.name_claimed) {
        publish_log();
        handlers_.on_changed();
    }
    if (!effects.keep_links.empty()) keep_links(std::move(effects.keep_links));
    if (effects.keep_labels) keep_labels(std::move(*effects.keep_labels));
    if (effects.keep_stop) keep_stop(std::move(*effects.keep_stop));
    if (effects.reopen_link) link_.reopen("the board does not answer");
    if (effects.port == Effects::Port::kTakeBack) {
        loader_.reset();
        link_.start();
    }
    if (effects.begin_anew) return finish(kBeginAnew);
    if (effects.fatal) {
        if (life_ == Life::kRunning) log_.error(effects.fatal->text, {});
        end_once_safe([this, status = effects.fatal->status] { finish(status); });
    }
}

void BoardAgent::publish(Effects& effects) {
    notes_.add(std::move(effects.notes), Clock::now());
    for (auto& [message, priority] : effects.publish) {
        if (!bus_) return;
        // A history has commands before the state that followed them.
        if (priority == mqtt::Priority::kAnnouncement) tell_notes();
        const bool stops = priority == mqtt::Priority::kUrgent;
        const bool commands = priority == mqtt::Priority::kReply && life_ == Life::kRunning;
        if (hears_stops_ && (stops || (commands && stop_line_->has_room_for(message))))
            stop_line_->answer(std::move(message));
        else
            bus_->publish(std::move(message), priority);
    }
}

void BoardAgent::tell_notes() {
    for (auto& note : notes_.take())
        if (bus_) bus_->publish(std::move(note), mqtt::Priority::kReply);
}

void BoardAgent::load(Effects::Load wanted) {
    auto usb = link::usb_port_of(wanted.path);
    if (options_.lent) usb.vendor = options_.lent->vendor, usb.product = options_.lent->product;
    auto loaders = link::boot_loaders(wanted.board, usb.vendor, usb.product);
    auto done = [this](const Expected<void>& result) {
        with_bridge([&](Time now, Effects& out) { bridge_.loaded(result, now, out); });
    };
    if (!loaders) {
        boost::asio::post(io_, [alive = std::weak_ptr(alive_), done, why = loaders.error()] {
            if (!alive.expired()) done(fail(why));
        });
        return;
    }
    loader_.emplace(io_,
                    Loader::Order{std::move(wanted.path), options_.avrdude, options_.firmware_folder,
                                  std::move(wanted.firmware), std::move(*loaders)},
                    Loader::Handlers{[this](std::string_view step, int percent) {
                                         with_bridge([&](Time, Effects&) { bridge_.loading(step, percent); });
                                     },
                                     done});
}

void BoardAgent::keep_labels(LabelsToKeep keep) {
    boost::asio::post(host_.disk, [this, alive = std::weak_ptr(alive_), &io = io_, files = label_files_,
                                   board = bridge_.name(), keep = std::move(keep)] {
        boost::asio::post(io, [this, alive, result = files.save(board, keep)] {
            if (!alive.expired())
                with_bridge([&](Time now, Effects& out) { bridge_.labels_kept(result, now, out); });
        });
    });
}

void BoardAgent::keep_stop(std::optional<model::StopInfo> stopped) {
    boost::asio::post(host_.disk, [this, alive = std::weak_ptr(alive_), &io = io_, files = stop_files_,
                                   board = bridge_.name(), stopped = std::move(stopped)] {
        boost::asio::post(io, [this, alive, result = files.save(board, stopped)] {
            if (alive.expired() || result) return;
            log_.error("a stop could not be kept: it ends with this agent", {{"why", result.error()}});
        });
    });
}

void BoardAgent::arm_timer() {
    auto deadline = bridge_.next_deadline();
    if (const auto due = notes_.next_deadline(); due && (!deadline || *due < *deadline)) deadline = due;
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
        if (error || ended()) return;
        note_running();
        armed_for_.reset();
        if (const auto due = notes_.next_deadline(); due && *due <= Clock::now()) tell_notes();
        with_bridge([&](Time now, Effects& out) {
            if (const auto due = bridge_.next_deadline(); due && *due <= now) bridge_.tick(now, out);
        });
    });
}

void BoardAgent::stop() {
    if (life_ != Life::kRunning) return;
    log_.info("stopping", {});
    end_once_safe([this] {
        Effects effects;
        bridge_.goodbye(Clock::now(), effects);
        perform(effects);  // nothing is written to the board any more
        finish(program::kExitOk);
    });
}

void BoardAgent::end_once_safe(std::function<void()> end) {
    if (life_ != Life::kRunning) return;
    life_ = Life::kMakingSafe;
    with_bridge([&](Time now, Effects& out) { bridge_.release_holds(now, out); });
    wait_until_safe(Clock::now() + kMakeSafe, std::move(end));
}

void BoardAgent::wait_until_safe(Time limit, std::function<void()> end) {
    if (ended()) return;
    if (bridge_.is_safe() || !bridge_.session().accepts_requests() || Clock::now() >= limit) {
        with_bridge([&](Time now, Effects& out) { bridge_.leave_line(now, out); });
        return wait_until_left(Clock::now() + kLeaveLine, std::move(end));
    }
    safe_timer_.expires_after(kLookAgain);
    safe_timer_.async_wait([this, limit, end = std::move(end)](boost::system::error_code error) mutable {
        if (!error) wait_until_safe(limit, std::move(end));
    });
}

void BoardAgent::wait_until_left(Time limit, std::function<void()> end) {
    if (ended()) return;
    if (bridge_.has_left_line() || Clock::now() >= limit) return end();
    safe_timer_.expires_after(kLookAgain);
    safe_timer_.async_wait([this, limit, end = std::move(end)](boost::system::error_code error) mutable {
        if (!error) wait_until_left(limit, std::move(end));
    });
}

void BoardAgent::finish(int status) {
    if (std::exchange(life_, Life::kEnded) == Life::kEnded) return;
    presence_ = Presence::kAway;
    tell_notes();
    timer_.cancel();
    reset_timer_.cancel();
    counters_timer_.cancel();
    statistics_timer_.cancel();
    safe_timer_.cancel();
    check_timer_.cancel();
    stops_timer_.cancel();
    stops_.reset();
    // These may be calls of their own.
    boost::asio::post(io_, [line = std::move(stop_line_), sources = std::move(source_bus_)] {});
    clients_.close();
    loader_.reset();
    link_.stop();
    // What was in the loop's queue already runs before that.
    auto tell = [this, status] {
        boost::asio::post(io_, [on_ended = handlers_.on_ended, status] { on_ended(status); });
    };
    if (!bus_) return tell();
    bus_->stop(kGoodbye, std::move(tell));
}

}  // namespace asip::agent
