// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>

#include "asip/bus/registry/items.hpp"
#include "asip/model/description.hpp"

namespace asip::cli {

/// Whether it is a serial port where nothing has ever answered ASIP: a board without our firmware.
bool speaks_no_asip(const model::Description& board);
bool speaks_no_asip(const bus::BoardItem& board);
/// A row does not say which link a board has.
bool speaks_no_asip(const bus::BriefBoard& board);

/// A port for people: "USB port 1.3" where its path says so, else the path.
std::string port_text(std::string_view path);

}  // namespace asip::cli
