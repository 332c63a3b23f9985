// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "asip/expected.hpp"

namespace asip::protocol {

/// One digital pin and its level.
struct PinLevel {
    int pin;
    bool high;
    friend bool operator==(const PinLevel&, const PinLevel&) = default;
};

/// The body of a digital event: `PORT,HEXMASK`.
struct PortState {
    int port;              ///< 0 to 255, the chip's own number
    std::uint32_t levels;  ///< one bit for each pin of the port
};
/// Fails when it is not two numbers of that form.
Expected<PortState> parse_port_state(std::string_view body);

/// Which port and bit each digital pin is, from the answer to `I,M`. Digital events name ports only, so that
/// without this map they cannot be assigned to pins.
class PortMap {
  public:
    struct Position {
        int port;
        std::uint32_t mask;  ///< its bit in PortState::levels; 0: the pin is on no port
    };

    PortMap() = default;
    /// One position for each pin, from pin 0 on.
    explicit PortMap(std::vector<Position> positions) : positions_(std::move(positions)) {}

    /// From the body of `@I,M`: `20,{4:1,4:2,...}`, port decimal, mask hexadecimal. Fails when it is cut
    /// off or miscounted.
    static Expected<PortMap> parse(std::string_view body);

    bool empty() const { return positions_.empty(); }
    std::size_t pin_count() const { return positions_.size(); }
    const std::vector<Position>& positions() const { return positions_; }

    /// The levels of every pin of that port, ascending by pin; empty when no pin is on it. Pins that are not
    /// inputs are among them, with a level that means nothing; callers who know the modes leave them out.
    std::vector<PinLevel> levels(const PortState& state) const;

  private:
    std::vector<Position> positions_;
};

}  // namespace asip::protocol
