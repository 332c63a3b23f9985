// SPDX-License-Identifier: Apache-2.0
#include "asip/program/keep_running.hpp"

#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>

#include "asip/mqtt/backoff.hpp"
#include "asip/program/exit_status.hpp"
#include "asip/program/log.hpp"
#include "asip/program/service_manager.hpp"
#include "asip/program/stop_signal.hpp"

namespace asip::program {
namespace {

constexpr Duration kRanLong = std::chrono::minutes(10);

// False: it was told to stop. From `announce` on it can be.
bool wait(Duration time, const std::function<void()>& announce) {
    boost::asio::io_context io;
    boost::asio::steady_timer timer(io, time);
    bool stopped = false;
    StopSignal stop(io, [&](int) {
        stopped = true;
        timer.cancel();
    });
    timer.async_wait([&](const boost::system::error_code&) { stop.cancel(); });
    announce();
    io.run();
    return !stopped;
}

}  // namespace

int keep_running(const std::function<int()>& service) {
    mqtt::Backoff pause(std::chrono::minutes(1), std::chrono::minutes(5));
    for (;;) {
        const Time began = Clock::now();
        const int status = service();
        if (!supervised() || (status != kExitBroker && status != kExitNameConflict)) return status;
        if (Clock::now() - began >= kRanLong) pause.reset();
        const Duration time = pause.next(system_random());
        const auto seconds = std::chrono::ceil<std::chrono::seconds>(time).count();
        const auto announce = [&] {
            log::warning("ended; beginning again",
                         {{"status", status}, {"in", std::to_string(seconds) + " s"}});
            tell_service_manager("STATUS=ended with status " + std::to_string(status) +
                                 "; beginning again, see the log");
        };
        if (!wait(time, announce)) return kExitOk;
    }
}

}  // namespace asip::program
