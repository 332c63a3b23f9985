// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "asip/expected.hpp"

namespace asip::protocol {

struct PinLevel {
    int pin;
    bool high;
    friend bool operator==(const PinLevel&, const PinLevel&) = default;
};

/// `PORT,HEXMASK`.
struct PortState {
    int port;              ///< 0 to 255, the chip's own number
    std::uint32_t levels;  ///< one bit for each pin of the port
};
Expected<PortState> parse_port_state(std::string_view body);

/// Port and bit of each digital pin, from the answer to `I,M`: digital events name ports only.
class PortMap {
  public:
    struct Position {
        int port;
        std::uint32_t mask;  ///< its bit in PortState::levels; 0: the pin is on no port
    };

    PortMap() = default;
    /// By pin.
    explicit PortMap(std::vector<Position> positions) : positions_(std::move(positions)) {}

    /// `20,{4:1,4:2,...}`, port decimal, mask hexadecimal. Fails on a damaged body.
    static Expected<PortMap> parse(std::string_view body);

    bool empty() const { return positions_.empty(); }
    const std::vector<Position>& positions() const { return positions_; }

    /// The levels of every pin of that port, ascending; those of pins that are no inputs mean nothing.
    std::vector<PinLevel> levels(const PortState& state) const;

  private:
    std::vector<Position> positions_;
};

}  // namespace asip::protocol
