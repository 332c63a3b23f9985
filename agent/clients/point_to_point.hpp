// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <deque>
#include <functional>
#include <list>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "agent/clients/client_framing.hpp"
#include "agent/counts/board_log.hpp"
#include "asip/expected.hpp"
#include "asip/link/tcp_stream.hpp"
#include "asip/session/action.hpp"
#include "asip/time.hpp"

namespace asip::agent {

/// Offers the board to clients over TCP. A client that sends faster than the board executes is read more
/// slowly; one that does not read is dropped at kMaxUnsentBytes. At kMaxClients a new client replaces the one
/// that was silent for longest, if that is kMayBeDropped. A client that ends its sending, as `nc -N` does,
/// gets its answers until nothing came for kQuietAfterEnd, or until kLongestAfterEnd.
class PointToPoint {
  public:
    static constexpr std::size_t kMaxUnsentBytes = 64 * 1024;
    static constexpr std::size_t kMaxClients = 64;
    static constexpr Duration kMayBeDropped = std::chrono::seconds(10);
    static constexpr Duration kQuietAfterEnd = std::chrono::seconds(2);
    static constexpr Duration kLongestAfterEnd = std::chrono::seconds(10);

    /// False: not now; the line is given again at the next resume(). `sent`: the earliest time, where that is
    /// long ago.
    using LineHandler =
        std::function<bool(session::ClientId client, std::string_view line, std::optional<Time> sent)>;
    /// The earliest time at which what is read now was sent, where that is long ago.
    using ReadsOld = std::function<std::optional<Time>()>;

    /// The port of the published Java programs, whose silent clients want frames.
    static constexpr std::uint16_t kJavaPort = 6789;

    /// `silence`: after it a client is taken to want plain lines, on kJavaPort frames.
    PointToPoint(boost::asio::io_context& io, BoardLog& log, Duration silence, ReadsOld reads_old,
                 LineHandler on_line);

    Expected<std::uint16_t, link::StreamError> listen(const link::TcpAddress& address,
                                                      ClientFraming::Kind framing);
    /// To all clients, or to one.
    void send(std::string_view line, std::optional<session::ClientId> to);
    /// Gives the lines once more that could not be accepted.
    void resume();
    void close();

  private:
    struct Client {
        session::ClientId id;
        std::unique_ptr<link::ByteStream> stream;
        ClientFraming framing;
        ClientFraming::Kind silent;  // what it wants if it sends nothing
        Time connected;
        Time heard;
        bool gone = false;  // erased at the next turn of the loop: its handlers may still be running
        struct Line {
            std::string text;
            std::optional<Time> sent;
        };
        std::optional<Time> reads_since = std::nullopt;  // what it sent, until all that waited is read
        std::deque<Line> waiting{};  // lines that could not be accepted yet; reading is paused meanwhile
        std::optional<Time> ended = std::nullopt;  // it sends no more
        Time read_until = {};                      // until then nothing was left to be read
        Time served = {};                          // the last line of it was taken, or for it alone was sent
    };
    /// When a client that sends no more is closed.
    static Time end_of(const Client& client);
    void accepted(std::unique_ptr<link::ByteStream> stream, ClientFraming::Kind framing,
                  ClientFraming::Kind silent);
    bool make_room();
    void received(Client& client, std::string_view bytes);
    void take(Client& client, std::vector<std::string> lines);
    static std::optional<Time> end_of_request(Client& client, Time now);
    void give(Client& client);
    std::size_t living() const;
    void drop(Client& client, const char* why);
    void watch_silence();
    void input_ended(Client& client);
    void close_ended();

    boost::asio::io_context& io_;
    BoardLog& log_;
    Duration silence_;
    ReadsOld reads_old_;
    LineHandler on_line_;
    boost::asio::steady_timer silence_timer_;
    boost::asio::steady_timer ended_timer_;
    std::vector<std::unique_ptr<link::TcpListener>> listeners_;
    std::list<Client> clients_;
    bool giving_ = false;
    session::ClientId next_id_ = 1;
    std::uint64_t refused_ = 0;
    std::optional<Time> refusal_logged_;
};

}  // namespace asip::agent
