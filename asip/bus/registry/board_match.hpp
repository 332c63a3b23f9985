// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "asip/bus/registry/items.hpp"
#include "asip/bus/registry/query.hpp"
#include "asip/model/description.hpp"
#include "asip/model/model_set.hpp"

namespace asip::bus {

/// Whether a board, or one service of it, is among what `query` asks for (sort, limit and cursor aside). The
/// rule is that of match.hpp. `description` may be null; `models` gives the units of standard models.
bool board_matches(const Query& query, const BoardItem& board, const model::Description* description,
                   const model::ModelSet& models);
bool service_matches(const Query& query, const ServiceItem& service, const model::Description* description,
                     const model::ModelSet& models);

/// The model of a service: its own, the standard one it refers to (another version of it where this one is
/// unknown), or what letter and title suggest; null when there is none.
model::ModelPtr model_of(const model::ServiceInfo& service, const model::ModelSet& models);

}  // namespace asip::bus
