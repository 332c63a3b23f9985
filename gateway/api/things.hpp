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
    std::string topic_root = "asip";
};

/// Boards as things and as exporters see them, and the values that are read of things. Pure.
class Things {
  public:
    static constexpr std::size_t kMaxBoards = 200;  ///< that are kept though no exporter has them
    static constexpr std::size_t kMaxWants = 1000;
    static constexpr Duration kWantFor = std::chrono::seconds(30);

    Things(ThingsOptions options, const model::ModelSet& models)
        : options_(std::move(options)), descriptions_(options_.topic_root), models_(models) {}

    const ThingsOptions& options() const { return options_; }
    const exports::WebOfThings& descriptions() const { return descriptions_; }
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
    exports::WebOfThings descriptions_;
    const model::ModelSet& models_;
    std::map<std::string, Known, std::less<>> boards_;
    std::size_t tidy_at_ = 2 * kMaxBoards;
    std::deque<std::shared_ptr<const exports::ExportedBoard>> last_;  // that were made
    std::map<std::pair<std::string, std::string>, Wanted> wants_;
};

}  // namespace asip::gateway::api
