// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <boost/asio/io_context.hpp>
#include <functional>
#include <list>
#include <memory>
#include <string>
#include <vector>

#include "asip/bus/request/asker_turns.hpp"
#include "asip/mqtt/client.hpp"

namespace asip::agent {

/// A connection to the broker for stops alone: messages of one connection come one behind the other, and a
/// stop must not wait behind others. Boards of a process with the same credentials share one. One thread: all
/// calls and handlers on the io_context.
class StopLine {
  public:
    struct Handlers {
        std::function<void(const mqtt::Message&)> on_stop;
        /// Whether stops arrive; `why`, for a person. Called for each attempt to connect.
        std::function<void(bool heard, const std::string& why)> on_heard;
    };
    /// Stops of one board arrive while this lives. It may outlive the line.
    class [[nodiscard]] Listening {
      public:
        Listening() = default;
        Listening(Listening&&) = default;
        Listening& operator=(Listening&&) = default;
        void reset() { entry_.reset(); }
        explicit operator bool() const { return entry_ != nullptr; }

      private:
        friend class StopLine;
        explicit Listening(std::shared_ptr<void> entry) : entry_(std::move(entry)) {}
        std::shared_ptr<void> entry_;
    };

    StopLine(boost::asio::io_context& io, mqtt::Options options);

    /// `topic`: of one board. No handler is called from inside this call.
    Listening listen(std::string topic, Handlers handlers);

    /// Sends the answer to a stop here: on the board's connection it would wait behind the acknowledgement of
    /// each command. Askers take turns: the answers of a flood of stops wait for themselves, and beyond its
    /// bound are dropped.
    void answer(mqtt::Message message);

    /// Whether the answer to a command delays none to a stop here. On the board's connection it would wait
    /// behind acknowledgements and reports: a broker in a flood reads one of them in each of its turns.
    bool has_room_for(const mqtt::Message& answer) const;

  private:
    std::size_t under_way() const;
    struct Entry {
        std::string topic;
        Handlers handlers;
    };
    void send_answers();
    void tell(bool heard, const std::string& why);
    std::vector<std::shared_ptr<Entry>> entries();

    std::vector<std::weak_ptr<Entry>> entries_;
    /// One request for all boards of a process gets an answer of each.
    bus::AskerTurns<mqtt::Message, 4096, 16'384> answers_;
    std::shared_ptr<mqtt::Client> client_;
};

/// The stop lines of a process, one for each set of credentials.
class StopLines {
  public:
    explicit StopLines(boost::asio::io_context& io) : io_(io) {}
    /// It lives as long as it is held, and connects at once.
    std::shared_ptr<StopLine> line(const mqtt::Options& options);

  private:
    struct Open {
        mqtt::Options options;
        std::weak_ptr<StopLine> line;
    };
    boost::asio::io_context& io_;
    std::list<Open> open_;
};

}  // namespace asip::agent
