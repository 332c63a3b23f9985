// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <cstdint>
#include <deque>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "asip/time.hpp"
#include "cli/text/table.hpp"

namespace asip::cli {

/// What `asipctl top` shows: rate, trend, age, errors and round trip of each service, over a sliding window.
/// Pure.
class TopModel {
  public:
    /// Rates are over the last `window`.
    explicit TopModel(Duration window) : window_(window) {}
    /// From now on values are heard: until a window is over, rates are over what there was of it.
    void begin(Time now) { began_ = now; }

    void value(const std::string& board, const std::string& service, const std::string& payload, Time now);
    void error(const std::string& board, const std::string& service, Time now);
    /// A service that is announced, so that it is shown before its first event. `period` in milliseconds,
    /// where known: a value older than three of them is shown as stale.
    void announced(const std::string& board, const std::string& service, std::optional<int> period);
    void state(const std::string& board, const std::string& state);
    /// Nothing: the board did not answer.
    void round_trip(const std::string& board, std::optional<std::chrono::duration<double>> took);

    enum class Order { kName, kRate, kAge, kErrors, kTrip };
    /// The highest first; names as they are.
    void sort_by(Order order) { order_ = order; }

    /// `most`: rows, 0: all. Of those that do not fit the number stands in left_out().
    Table table(Time now, std::size_t most = 0);
    std::size_t left_out() const { return left_out_; }
    /// One object a service: board, state, round_trip_ms, service, rate (a second), age (seconds), errors,
    /// last. What is not known is left out.
    std::vector<nlohmann::json> records(Time now);

  private:
    struct Service {
        std::map<Time, std::uint32_t> arrivals;  // in slots of a tenth of the window
        std::uint64_t errors = 0;
        std::optional<Time> last;
        std::optional<int> period;
        std::string payload;
        std::deque<double> trend;  // of the value's first number: one for each slot in which one came
        Time sampled;
    };
    static void sample(Service& service, Duration slot, Time now);
    struct Board {
        std::string state;
        std::optional<std::optional<std::chrono::duration<double>>> round_trip;
        std::map<std::string, Service> services;
    };
    /// A board without services is a row, too.
    struct Row {
        const std::string* board_name;
        Board* board;
        const std::string* service_name = nullptr;
        Service* service = nullptr;
    };
    std::vector<Row> rows(Time now);
    double rate(Service& service, Time now) const;
    double key(const Row& row, Time now) const;

    Duration window_;
    std::optional<Time> began_;
    Order order_ = Order::kName;
    std::size_t left_out_ = 0;
    std::map<std::string, Board> boards_;
};

}  // namespace asip::cli
