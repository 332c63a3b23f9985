// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "asip/expected.hpp"
#include "asip/model/description.hpp"
#include "asip/model/model_set.hpp"

namespace asip::load {

/// What all simulated boards have in common: their services, each by its standard model. Made once, shared.
struct BoardKind {
    struct Service {
        model::ModelPtr model;
        std::string value;    ///< JSON that it reports, of the model's examples; empty: it has no events
        std::string command;  ///< JSON that it takes, of the same; empty: it has none
    };
    /// In the order in which descriptions list them. Not empty.
    std::vector<Service> services;

    /// Null: the board has no service of that name.
    const Service* service(std::string_view name) const;
    /// Board number `number`, as an agent at a serial port would describe it; without a session.
    model::Description describe(std::size_t number, const model::AgentInfo& agent) const;
};

/// The services in the order given. Fails with the nearest name when there is no such model, and when one is
/// given twice or there are more than a description may have.
Expected<BoardKind> make_board_kind(const std::vector<std::string>& models);

}  // namespace asip::load
