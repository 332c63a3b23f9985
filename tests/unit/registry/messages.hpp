// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "tests/unit/catalogue/bus_messages.hpp"

/// The messages that the tests of the catalogue are made of.
namespace asip::registry {

using namespace std::chrono_literals;
using catalogue::at;
using catalogue::board_name;
using catalogue::description;
using catalogue::DescriptionText;
using catalogue::instant;
using catalogue::OwnedMessage;
using catalogue::retained;
using catalogue::service_name;
using catalogue::state;
using catalogue::traffic;

}  // namespace asip::registry
