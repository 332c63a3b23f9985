// SPDX-License-Identifier: Apache-2.0
#include "agent/program/supervisor.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdint>
#include <ctime>
#include <map>
#include <utility>

#include "agent/program/running_board.hpp"
#include "asip/program/exit_status.hpp"
#include "asip/program/log.hpp"
#include "asip/program/open_files.hpp"
#include "asip/program/service_manager.hpp"

namespace asip::agent {

namespace log = program::log;

namespace {

// A board that was served for so long begins with short pauses again.
constexpr Duration kServedLong = std::chrono::minutes(1);
// The start of each is a probe, which all agents of the bus get.
constexpr Duration kBetweenStarts = std::chrono::milliseconds(10);
constexpr Duration kBetweenReports = std::chrono::milliseconds(500);
constexpr std::size_t kNamedInStatus = 5;

/// Files that the text names may have changed though it has not: passwords and credentials do.
bool same_options(const PlannedBoard& one, const PlannedBoard& other) {
    const auto& a = one.options.mqtt;
    const auto& b = other.options.mqtt;
    return one.text == other.text && a.brokers == b.brokers && a.user == b.user && a.password == b.password &&
           a.ca_file == b.ca_file && a.cert_file == b.cert_file && a.key_file == b.key_file;
}

const char* why_ended(int status) {
    switch (status) {
        case program::kExitBroker:
            return "the broker refuses the connection";
        case program::kExitBoard:
            return "no ASIP board answers at the port, or it is in use or not permitted";
        case program::kExitNameConflict:
            return "another agent has the board's name";
        default:
            return "something is in the way";
    }
}

/// Not, once it was closed.
bool can_reach_terminal() {
    const int terminal = ::open("/dev/tty", O_RDWR | O_NOCTTY | O_CLOEXEC);
    if (terminal >= 0) ::close(terminal);
    return terminal >= 0;
}

}  // namespace

Supervisor::Supervisor(Plan plan, std::function<Expected<Plan>()> read_again)
    : several_(plan.several()),
      read_again_(std::move(read_again)),
      has_terminal_(can_reach_terminal()),
      random_(system_random()),
      stop_signal_(
          io_, [this](int) { stop(); }, program::StopSignal::Hangup::kElsewhere),
      reload_signal_(io_),
      report_timer_(io_) {
    for (auto& board : plan.boards)
        boards_.push_back(std::make_shared<Board>(io_, std::move(board), several_));
    if (plan.lending) serve_cables(std::move(*plan.lending));
}

Supervisor::~Supervisor() {
    disk_.join();
}

int Supervisor::run() {
    if (several_ || !program::ignored(SIGHUP)) {  // by nohup
        reload_signal_.add(SIGHUP);
        wait_for_reload();
    }
    if (several_) {
        program::allow_many_open_files();  // each board needs four, and one more for each client
        if (!cables_) log::info("serving the boards of the configuration file", {{"boards", boards_.size()}});
    }
    start_all();
    program::tell_service_manager("READY=1");
    report_soon();
    io_.run();
    return status_;
}

void Supervisor::start_all() {
    Duration after{};
    for (auto& board : boards_) {
        start(*board, after);
        after += kBetweenStarts;
    }
}

void Supervisor::start(Board& board, Duration after) {
    board.start_timer.expires_after(after);
    board.start_timer.async_wait([this, weak = board.weak_from_this()](boost::system::error_code error) {
        if (const auto alive = weak.lock(); !error && !stopping_ && alive && !alive->agent) serve(*alive);
    });
}

void Supervisor::serve(Board& board) {
    auto options = board.plan.options;
    options.bridge.started_unix = static_cast<std::uint64_t>(std::time(nullptr));
    if (board.name_taken) options.bridge.takeover = false;
    board.started = Clock::now();
    board.agent = std::make_unique<BoardAgent>(
        BoardAgent::Host{io_, disk_, stops_, agents_, several_ || program::supervised(), several_},
        std::move(options),
        BoardAgent::Handlers{[this, &board](int status) { ended(board, status); },
                             [this, &board] {
                                 tell_lender(board);
                                 report_soon();
                             }});
    board.agent->start();
}

void Supervisor::ended(Board& board, int status) {
    board.agent.reset();
    report_soon();
    if (!stopping_ && board.wanted && status == BoardAgent::kBeginAnew) return start(board, {});
    if (!several_ && !(program::supervised() && !stopping_ && status != program::kExitOk)) {
        status_ = std::max(status, program::kExitOk);
        stopping_ = true;
        stop_signal_.cancel();
        return io_.stop();
    }
    if (stopping_ || !board.wanted) return remove(board);
    if (std::exchange(board.changed, false)) return start(board, {});
    start_again(board, status);
}

void Supervisor::start_again(Board& board, int status) {
    if (Clock::now() >= board.started + kServedLong) board.pause.reset();
    board.last_status = status;
    board.name_taken = board.name_taken || status == program::kExitNameConflict;
    const auto pause = board.pause.next(random_);
    log::warning("the agent of one board has ended; starting it again",
                 {{"board", board.plan.key},
                  {"status", status},
                  {"in", std::to_string(std::chrono::ceil<std::chrono::seconds>(pause).count()) + " s"}});
    start(board, pause);
}

void Supervisor::remove(Board& board) {
    std::erase_if(boards_, [&](const auto& each) { return each.get() == &board; });
    if (!stopping_ || !boards_.empty()) return;
    stop_signal_.cancel();
    io_.stop();
}

void Supervisor::stop() {
    if (std::exchange(stopping_, true)) return;
    program::tell_service_manager("STOPPING=1");
    if (several_) log::info("stopping", {{"boards", boards_.size()}});
    if (cables_) cables_->stop();
    std::erase_if(boards_, [](const auto& board) { return !board->agent; });
    for (auto& board : boards_)
        board->agent->stop();
    if (boards_.empty()) io_.stop();
}

void Supervisor::wait_for_reload() {
    reload_signal_.async_wait([this](boost::system::error_code error, int) {
        if (error || stopping_) return;
        reload();
        wait_for_reload();
    });
}

void Supervisor::reload() {
    if (!several_ || cables_) return nothing_to_reload();
    timespec now{};
    clock_gettime(CLOCK_MONOTONIC, &now);
    program::tell_service_manager("RELOADING=1\nMONOTONIC_USEC=" +
                                  std::to_string(std::int64_t{now.tv_sec} * 1'000'000 + now.tv_nsec / 1000));
    if (auto plan = read_again_())
        apply(std::move(*plan));
    else
        log::error("the configuration file is not used; going on as before", {{"why", plan.error()}});
    program::tell_service_manager("READY=1");
    report_soon();
}

void Supervisor::nothing_to_reload() {
    if (has_terminal_ && !can_reach_terminal()) {
        log::info("the terminal was closed: stopping");
        return stop();
    }
    log::warning(
        "SIGHUP: there is no file with sections [board NAME] to read again; going on as before. For other "
        "options start the agent again");
}

void Supervisor::apply(Plan plan) {
    std::map<std::string, PlannedBoard*> planned;
    for (auto& board : plan.boards)
        planned[board.key] = &board;
    std::size_t removed = 0, changed = 0;
    for (std::size_t i = boards_.size(); i-- > 0;) {
        Board& board = *boards_[i];
        const auto found = planned.find(board.plan.key);
        const bool left = !std::exchange(board.wanted, found != planned.end());
        if (!board.wanted) {
            ++removed;
            if (board.agent)
                board.agent->stop();
            else
                remove(board);
            continue;
        }
        const bool same = same_options(board.plan, *found->second);
        if (!same) ++changed, board.name_taken = false;
        board.plan = std::move(*found->second);
        planned.erase(found);
        if (!board.agent) {
            board.pause.reset();
            start(board, {});
        } else if (!same || left) {
            board.changed = true;
            board.agent->stop();
        }
    }
    Duration after{};
    for (auto& [key, board] : planned) {
        boards_.push_back(std::make_shared<Board>(io_, std::move(*board), several_));
        start(*boards_.back(), after);
        after += kBetweenStarts;
    }
    log::info("configuration file read again",
              {{"boards", boards_.size()}, {"new", planned.size()}, {"changed", changed}, {"gone", removed}});
}

void Supervisor::report_soon() {
    if (!program::has_service_manager() || stopping_ || std::exchange(report_waits_, true)) return;
    report_timer_.expires_after(kBetweenReports);
    report_timer_.async_wait([this](boost::system::error_code error) {
        report_waits_ = false;
        if (!error && !stopping_) program::tell_service_manager("STATUS=" + status_text());
    });
}

std::string Supervisor::status_text() const {
    std::size_t online = 0, ended = 0, waiting = 0;
    std::string names, reasons;
    for (const auto& board : boards_) {
        if (board->agent && board->agent->online()) {
            ++online;
        } else if (board->agent && !board->agent->why_waiting().empty()) {
            if (++waiting <= kNamedInStatus)
                reasons += "; " + board->plan.key + " waits: " + board->agent->why_waiting();
        } else if (board->agent) {
            continue;
        } else if (board->last_status != 0 && ++ended <= kNamedInStatus) {
            names += (names.empty() ? "" : ", ") + board->plan.key + " (" +
                     std::to_string(board->last_status) + ")";
        }
    }
    if (!several_ && ended > 0)
        return std::string(why_ended(boards_.front()->last_status)) + "; asking again, see the log";
    if (!several_ && online > 0) return "on the bus";
    if (!several_) {
        const auto& agent = boards_.front()->agent;
        return agent && !agent->why_waiting().empty() ? "waiting: " + agent->why_waiting()
                                                      : "waiting for the board or the broker";
    }
    auto text = std::to_string(online) + " of " + std::to_string(boards_.size()) + " boards on the bus";
    if (ended > 0) text += "; ended and to be started again: " + names;
    if (ended > kNamedInStatus) text += " and " + std::to_string(ended - kNamedInStatus) + " more";
    text += reasons;
    if (waiting > kNamedInStatus) text += "; " + std::to_string(waiting - kNamedInStatus) + " more wait";
    return text;
}

}  // namespace asip::agent
