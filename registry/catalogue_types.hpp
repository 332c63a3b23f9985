// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "asip/catalogue/catalogue.hpp"

/// The names of the catalogue that a registry uses as its own.
namespace asip::registry {

using catalogue::Announcement;
using catalogue::Applied;
using catalogue::Catalogue;
using catalogue::CatalogueStats;
using catalogue::Event;
using catalogue::Instant;
using catalogue::kRefusals;
using catalogue::kStates;
using catalogue::Refusal;
using catalogue::UnitsOf;

}  // namespace asip::registry
