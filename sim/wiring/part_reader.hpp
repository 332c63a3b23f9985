// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "asip/text/json_reader.hpp"
#include "sim/board_kind.hpp"

namespace asip::sim {

/// After a fault every read gives its default.
class PartReader {
  public:
    PartReader(text::JsonReader& settings, const BoardKind& board, bool has_world = false)
        : settings_(settings), board_(board), has_world_(has_world) {}

    bool has(const std::string& key) { return settings_.has(key); }
    /// Required: a number, "13" or "A0".
    int pin(const std::string& key);
    /// Exactly otherwise.size() pins; `otherwise` if the member is missing.
    std::vector<int> pins(const std::string& key, std::vector<int> otherwise);
    double number(const std::string& key, double otherwise, double minimum, double maximum) {
        return settings_.number(key, otherwise, minimum, maximum);
    }
    bool is_analog(int pin) const { return board_.pins.at(static_cast<std::size_t>(pin)).channel >= 0; }
    int sda() const { return board_.sda; }
    int scl() const { return board_.scl; }
    /// Required, not empty.
    std::string text(const std::string& key);
    /// For each of at most 64 items of a list, which may be missing.
    void each(const std::string& key, const std::function<void(PartReader&)>& read);
    /// "must be above min".
    void fault(const std::string& key, const std::string& reason) { settings_.fault(key, reason); }
    bool flag(const std::string& key) { return settings_.flag(key); }
    void need_world();

  private:
    int parse(const std::string& key, const nlohmann::json& value);

    text::JsonReader& settings_;
    const BoardKind& board_;
    bool has_world_;
};

}  // namespace asip::sim
