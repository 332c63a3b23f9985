#pragma once
#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <functional>
#include <memory>
#include <string>

#include "agent/options.hpp"
#include "asip/link/byte_stream.hpp"
#include "asip/link/serial_port.hpp"

namespace asip::agent {

/// Keeps the way to the board open: opens the port or connection, and again whenever it is gone, for ever. A
/// serial port is opened by its stable name, so that it is found again whatever number the kernel gives it.
class BoardLink {
  public:
    struct Handlers {
        std::function<void(const session::LinkTraits&, model::LinkInfo)> on_up;
        std::function<void(const link::StreamError& why)> on_down;
        std::function<void(std::string_view)> on_bytes;
        /// It cannot be opened; said at every attempt. `first`: at the first attempt of all; a port that
        /// appeared later may yet get its rights.
        std::function<void(const link::StreamError&, bool first)> on_failed;
    };

    BoardLink(boost::asio::io_context& io, const AgentOptions& options, Handlers handlers);
    ~BoardLink();

    void start();
    void stop();
    void write(std::string_view bytes);
    /// Sets the line's rate once everything written has left; then calls `done`. What is written meanwhile
    /// comes after.
    void set_rate(unsigned baud, std::function<void(bool)> done);
    /// Restarts the board by DTR, if the port has that line; then on_up is called anew.
    void restart_board();

  private:
    void open();
    void open_serial();
    void open_tcp();
    void opened(std::unique_ptr<link::ByteStream> stream, model::LinkInfo info);
    void pulse_dtr();
    void closed(const link::StreamError& error);
    void failed(const link::StreamError& error);
    void retry();
    void poll_drained();

    boost::asio::io_context& io_;
    const AgentOptions& options_;
    Handlers handlers_;
    std::string path_;
    std::unique_ptr<link::ByteStream> stream_;
    link::SerialPort* serial_ = nullptr;
    std::shared_ptr<void> connecting_;
    boost::asio::steady_timer retry_timer_;
    boost::asio::steady_timer drain_timer_;
    model::LinkInfo info_;
    bool tried_ = false;
    bool stopped_ = false;
    unsigned wanted_baud_ = 0;  // 0: no change of rate under way
    std::function<void(bool)> rate_done_;
    std::string held_;
};

}  // namespace asip::agent
