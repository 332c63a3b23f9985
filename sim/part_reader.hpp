#pragma once
#include <string>

#include "asip/text/json_reader.hpp"
#include "sim/board_kind.hpp"

namespace asip::sim {

/// Reads the settings of one part. After a fault every read gives its default.
class PartReader {
  public:
    PartReader(text::JsonReader& settings, const BoardKind& board) : settings_(settings), board_(board) {}

    bool has(const std::string& key) { return settings_.has(key); }
    /// A required pin: a number, "13" or "A0". 0 after a fault.
    int pin(const std::string& key);
    /// `otherwise` where there is none.
    double number(const std::string& key, double otherwise, double minimum, double maximum) {
        return settings_.number(key, otherwise, minimum, maximum);
    }
    /// The pins of the board's I2C bus.
    int sda() const { return board_.sda; }
    int scl() const { return board_.scl; }
    /// False where there is none.
    bool flag(const std::string& key) { return settings_.flag(key); }

  private:
    text::JsonReader& settings_;
    const BoardKind& board_;
};

}  // namespace asip::sim
