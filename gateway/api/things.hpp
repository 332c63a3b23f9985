// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <deque>
#include <map>
#include <memory>
#include <string>
#include <utility>

#include "asip/caller/caller.hpp"
#include "gateway/export/exported_board.hpp"
#include "gateway/export/web_of_things.hpp"
#include "gateway/mirror/mirror.hpp"

namespace asip::gateway::api {

/// What the Web of Things is shown over HTTP.
struct ThingsOptions {
    bool enabled = true;
    exports::WebOfThings::Options dialect;
    /// Where consumers find the broker: "mqtt://pi.local:1883", or ":1883" behind the name by which they
    /// found the gateway. Empty: no forms of MQTT.
    std::string broker;
    bool broker_password = false;
};

/// Boards as things and as exporters see them, and the values that are read of things. Pure.
class Things {
  public:
    static constexpr std::size_t kMaxBoards = 200;  ///< that are kept though no exporter has them
    static constexpr std::size_t kMaxWants = 1000;
    static constexpr Duration kWantFor = std::chrono::seconds(30);

    Things(ThingsOptions options, const model::ModelSet& models)
        : options_(std::move(options)), dialect_(options_.dialect), models_(models) {}

    const ThingsOptions& options() const { return options_; }
    const exports::WebOfThings& dialect() const { return dialect_; }
    struct Found {
        std::string state;    ///< of the catalogue
        std::string session;  ///< of its description
        std::shared_ptr<const exports::ExportedBoard> board;
    };
    /// Making a board costs more than all else of a request: it is made again when its description or its
    /// list changed, and shared. Nothing: it is not known, or has no description.
    std::optional<Found> find(Mirror& mirror, const std::string& name, const Instant& now);
    /// Demands a service's values for a while, of boards that report on demand. False: they were demanded
    /// already.
    bool want(caller::Caller& caller, const std::string& board, const std::string& service, Time now);

  private:
    struct Known {
        std::size_t hash = 0;  // of the description
        std::size_t bytes = 0;
        Standing::List list;
        std::weak_ptr<const exports::ExportedBoard> board;
    };
    struct Wanted {
        bus::Demander::Want want;
        Time until;
    };

    ThingsOptions options_;
    exports::WebOfThings dialect_;
    const model::ModelSet& models_;
    std::map<std::string, Known, std::less<>> boards_;
    std::size_t tidy_at_ = 2 * kMaxBoards;
    std::deque<std::shared_ptr<const exports::ExportedBoard>> last_;  // that were made
    std::map<std::pair<std::string, std::string>, Wanted> wants_;
};

}  // namespace asip::gateway::api
