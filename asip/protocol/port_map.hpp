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

/// The body of a digital event: `PORT,HEXMASK`.
struct PortState {
    int port;
    std::uint32_t levels;
};
Expected<PortState> parse_port_state(std::string_view body);

/// Which port and bit each pin is, from the answer to `I,M`. Without it a digital event names no pins.
class PortMap {
  public:
    struct Position {
        int port;
        std::uint32_t mask;  // 0: the pin is on no port
    };

    PortMap() = default;
    explicit PortMap(std::vector<Position> positions) : positions_(std::move(positions)) {}

    /// From the body of `@I,M`: `20,{4:1,4:2,...}`, port decimal, mask hexadecimal.
    static Expected<PortMap> parse(std::string_view body);

    bool empty() const { return positions_.empty(); }
    std::size_t pin_count() const { return positions_.size(); }
    const std::vector<Position>& positions() const { return positions_; }

    /// Levels of every pin of that port, ascending by pin; empty when no pin is on it. Callers who know the
    /// modes leave out pins that are no inputs.
    std::vector<PinLevel> levels(const PortState& state) const;

  private:
    std::vector<Position> positions_;
};

}  // namespace asip::protocol
