// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "asip/text/json_reader.hpp"
#include "sim/board_kind.hpp"

namespace asip::sim {

/// Reads the settings of one part. After a fault every read gives its default.
class PartReader {
  public:
    PartReader(text::JsonReader& settings, const BoardKind& board, bool has_world = false)
        : settings_(settings), board_(board), has_world_(has_world) {}

    bool has(const std::string& key) { return settings_.has(key); }
    /// A required pin: a number, "13" or "A0". 0 after a fault.
    int pin(const std::string& key);
    /// A list of as many pins as `otherwise` has, which is what it is where there is none.
    std::vector<int> pins(const std::string& key, std::vector<int> otherwise);
    /// `otherwise` where there is none.
    double number(const std::string& key, double otherwise, double minimum, double maximum) {
        return settings_.number(key, otherwise, minimum, maximum);
    }
    /// Whether the pin can be read as an analog input.
    bool is_analog(int pin) const { return board_.pins.at(static_cast<std::size_t>(pin)).channel >= 0; }
    /// The pins of the board's I2C bus.
    int sda() const { return board_.sda; }
    int scl() const { return board_.scl; }
    /// A required text; a fault where it is empty.
    std::string text(const std::string& key);
    /// Calls `read` with a reader of each item of a list, which may be missing; at most 64.
    void each(const std::string& key, const std::function<void(PartReader&)>& read);
    /// A fault of this part: "must be above min".
    void fault(const std::string& key, const std::string& reason) { settings_.fault(key, reason); }
    /// False where there is none.
    bool flag(const std::string& key) { return settings_.flag(key); }
    /// A fault where the board stands in no world.
    void need_world();

  private:
    int parse(const std::string& key, const nlohmann::json& value);

    text::JsonReader& settings_;
    const BoardKind& board_;
    bool has_world_;
};

}  // namespace asip::sim
