// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "asip/model/description.hpp"
#include "asip/model/service_model.hpp"
#include "asip/time.hpp"
#include "cli/commands/get.hpp"

namespace asip::cli {

/// One line of `asipctl get BOARD`.
struct ValueRow {
    std::string board;
    std::string service;
    std::string what;  ///< `distance 0`, `13 status lamp`; of something that was set its command in front
    nlohmann::json value;
    std::string unit;
    std::string text;          ///< the value for people, with its unit
    std::string how;           ///< "reported", "asked", "set"
    std::optional<Time> when;  ///< none: it was set at a time that is not known
};

/// What one service of a board reported and was set to. Pure.
class ServiceValues {
  public:
    /// `payload`: of `BOARD/SERVICE/out`, or the answer of the board. Parts of a map come together.
    void take(const nlohmann::json& payload, const std::string& how, Time now);
    void set(nlohmann::json set) { set_ = std::move(set); }
    bool empty() const { return events_.empty(); }

    /// `model` may be null. Pins of the I/O service go by their names and levels.
    std::vector<ValueRow> rows(const model::Description& board, const std::string& service,
                               const model::ServiceModel* model) const;

  private:
    struct Event {
        nlohmann::json value;
        std::string how;
        Time when;
    };
    std::map<std::string, Event> events_;
    nlohmann::json set_;
};

/// `asipctl get BOARD`, with patterns and -l: all values of the boards.
int run_get_all(const GetOptions& options, Environment& environment);

}  // namespace asip::cli
