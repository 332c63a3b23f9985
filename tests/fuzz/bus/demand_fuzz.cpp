// SPDX-License-Identifier: Apache-2.0
// Demands from strangers: refused with a reason, or within the limits, and what was read can be written and
// read again.
#include <cstdint>

#include "asip/bus/request/demand.hpp"
#include "tests/fuzz/require.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace asip::bus;
    const auto demand = parse_demand({reinterpret_cast<const char*>(data), size});
    if (!demand) {
        REQUIRE(!demand.error().empty());
        return 0;
    }
    REQUIRE(size <= kMaxDemandBytes);
    REQUIRE(demand->services.size() <= kMaxDemandedServices);
    REQUIRE(demand->lease.count() >= 1 && demand->lease <= kMaxDemandLease);
    for (const auto& [name, hz] : demand->services)
        REQUIRE(can_be_demanded(name) && hz > 0);
    const auto again = parse_demand(to_text(*demand));
    REQUIRE(again && again->services == demand->services && again->lease == demand->lease);
    return 0;
}
