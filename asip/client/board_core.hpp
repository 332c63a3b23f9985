// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "asip/client/board.hpp"
#include "asip/client/signal.hpp"
#include "asip/time.hpp"

namespace asip::client {

/// What the handles of one board share: its transport and what the board reported so far.
class Board::Core final : public Transport::Listener, public std::enable_shared_from_this<Core> {
  public:
    using Json = nlohmann::json;

    Core(std::unique_ptr<Transport> transport, Options options);
    Core(const Core&) = delete;
    Core& operator=(const Core&) = delete;
    ~Core();

    Transport& transport() { return *transport_; }
    bool online() const { return online_ && !closed_; }
    void opened();
    void close();

    void on_event(const std::string& service, const Json& event) override;
    void on_presence(bool there) override;
    void on_values(const std::string& service) override;

    // Coroutines hold the core by a shared_ptr of their own: the last Board may go while they are suspended.
    static Awaitable<Json> command(std::shared_ptr<Core> core, std::string service, Json command);
    static Awaitable<void> raw(std::shared_ptr<Core> core, std::string line);
    static Awaitable<void> io(std::shared_ptr<Core> core, Json command);
    static Awaitable<bool> digital_read(std::shared_ptr<Core> core, int pin);
    static Awaitable<int> analog_read(std::shared_ptr<Core> core, int channel);

    /// A pin that becomes an output reports no more: its last level means nothing.
    void forget_level(int pin) { levels_.erase(pin); }

    Signal<const Json&>& events(const std::string& service) { return events_[service]; }
    Signal<const Json&>& values(const std::string& service) { return values_[service]; }
    Signal<bool>& digital(int pin) { return digital_[pin]; }
    Signal<int>& analog(int channel) { return analog_signals_[channel]; }
    Signal<bool>& presence() { return presence_; }
    /// Emitted once, at the end.
    Signal<>& ended() { return ended_; }

  private:
    struct Sample {
        int value;
        Time when;
    };

    void take_digital(const Json& levels);
    void take_analog(const Json& values);
    std::optional<int> fresh_sample(int channel) const;
    /// Waits until `holds` does, looking again at each event and change of presence; false when it does not
    /// in time.
    template <class Condition>
    static boost::asio::awaitable<bool> wait_for(std::shared_ptr<Core> core, Condition holds, Duration limit);
    void wake();

    std::unique_ptr<Transport> transport_;
    Options options_;
    bool online_ = false;
    bool closed_ = false;
    std::map<int, bool> levels_;
    std::map<int, Sample> samples_;
    std::map<std::string, Signal<const Json&>> events_;
    std::map<std::string, Signal<const Json&>> values_;
    std::map<int, Signal<bool>> digital_;
    std::map<int, Signal<int>> analog_signals_;
    Signal<bool> presence_;
    Signal<> ended_;
    std::set<boost::asio::steady_timer*> waiters_;
};

}  // namespace asip::client
