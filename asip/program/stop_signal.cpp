// SPDX-License-Identifier: Apache-2.0
#include "asip/program/stop_signal.hpp"

#include <unistd.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/signal_set.hpp>
#include <csignal>
#include <utility>

namespace asip::program {

struct StopSignal::State : std::enable_shared_from_this<State> {
    State(boost::asio::io_context& io, std::function<void(int)> callback, Hangup hangup)
        : signals(io, SIGINT, SIGTERM), stop(std::move(callback)) {
        hangup_stops = hangup == Hangup::kStops && !ignored(SIGHUP);
        if (hangup_stops) signals.add(SIGHUP);
    }

    /// The second SIGHUP may come as late as this, when no handler waits for signals any more.
    ~State() {
        if (!asked || !hangup_stops) return;
        sigset_t hangup, before;
        sigemptyset(&hangup);
        sigaddset(&hangup, SIGHUP);
        pthread_sigmask(SIG_BLOCK, &hangup, &before);
        boost::system::error_code ignored;
        signals.clear(ignored);
        std::signal(SIGHUP, SIG_IGN);
        pthread_sigmask(SIG_SETMASK, &before, nullptr);
    }

    void wait() {
        signals.async_wait([self = shared_from_this()](const boost::system::error_code& error, int number) {
            if (!error) self->arrived(number);
        });
    }

    void arrived(int number) {
        if (asked && number != SIGHUP) _exit(128 + number);
        wait();
        if (!std::exchange(asked, true)) stop(number);
    }

    boost::asio::signal_set signals;
    std::function<void(int)> stop;
    bool hangup_stops = false;
    bool asked = false;
};

bool ignored(int signal) {
    struct sigaction action{};
    return sigaction(signal, nullptr, &action) == 0 && action.sa_handler == SIG_IGN;
}

StopSignal::StopSignal(boost::asio::io_context& io, std::function<void(int signal)> stop, Hangup hangup)
    : state_(std::make_shared<State>(io, std::move(stop), hangup)) {
    state_->wait();
}

StopSignal::~StopSignal() {
    cancel();
}

void StopSignal::cancel() {
    boost::system::error_code ignored;
    state_->signals.cancel(ignored);
}

}  // namespace asip::program
