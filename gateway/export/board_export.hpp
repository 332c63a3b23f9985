// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "asip/mqtt/message.hpp"
#include "gateway/export/export.hpp"
#include "gateway/export/value_pacer.hpp"

namespace asip::gateway::exports {

/// What each export has beside its dialect: its turn among gateways, and the boards that it takes up.
class BoardExport : public Export {
  public:
    struct Options {
        std::string gateway;    ///< unique for each process
        std::string host;       ///< name of this machine
        double per_second = 5;  ///< values of one property
        /// False: nothing is exported; what a gateway of this machine left on the broker is cleared.
        bool enabled = true;
        /// Clear it whichever machine it was (asip-gateway clean).
        bool clear_all = false;
    };

    void subscribed(Time now) override { turn_.subscribed(now); }
    void disconnected() override { turn_.disconnected(); }
    void changed(std::set<std::string> boards, Time now) override;
    bool active() const override { return phase_ == Phase::kActive; }
    const Turn& turn() const override { return turn_; }
    bool finished() const override { return phase_ == Phase::kFinished; }

  protected:
    enum class Phase {
        kIdle,
        kConnecting,
        kPreparing,  ///< connected: reads what is retained, or waits for a host
        kActive,
        kFinished,
    };
    struct ShownBoard {
        std::shared_ptr<const ExportedBoard> board;  // as far as its document has room
        std::shared_ptr<const ExportedBoard> whole;
        std::string session;
        bool there = false;
        std::map<std::string, std::vector<std::size_t>, std::less<>> by_service;  // properties with values
        std::vector<bus::Demander::Want> wants;

        bool is_other(const ExportedBoard& now) const { return !whole || !(*whole == now); }
    };

    /// `place`: where the documents are.
    BoardExport(Options options, std::string place, Random random, Port port);

    virtual std::string lease() const = 0;
    virtual void connect() = 0;
    /// Ends the connection; `why` goes to the log, unless it is empty.
    virtual void become_idle(const std::string& why) = 0;
    virtual void pump(Time now) = 0;

    void lease_said(const mqtt::Message& message, Time now);
    /// Takes or renews the lease over the new connection. False: another gateway was faster. `did`: for the
    /// log, where this gateway did not hold it before.
    bool claim(const std::string& did, Time now);
    /// Each tick(): begins a connection when it is time to, and renews the lease. True: boards are shown.
    bool keep_turn(Time now);
    void retain(std::string topic, std::string payload, int qos);
    void take_up(ShownBoard& shown, std::shared_ptr<const ExportedBoard> board,
                 const std::function<std::size_t(const ExportedBoard&)>& bytes);

    Options options_;
    Duration between_;  // values of one property
    Port port_;
    Turn turn_;
    Seldom seldom_{[this](const std::string& sentence) { port_.log(sentence); }};
    Phase phase_ = Phase::kIdle;
    std::set<std::string> dirty_;  // boards to look at
    Time now_{};
};

}  // namespace asip::gateway::exports
