// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "asip/bus/registry/label_selector.hpp"
#include "cli/ask/board_source.hpp"
#include "cli/ask/bus_session.hpp"
#include "cli/commands/pin.hpp"

namespace asip::cli {

/// Reads or sets a pin of each board that is chosen and has not said goodbye, all at a time, and prints a row
/// for each. Nothing is sent where the pin is wrong for one of them. kExitOk: each did it; else what the
/// first failure means.
int run_pin_group(const PinOptions& options, const Target& target, const bus::LabelSelector& labels,
                  Environment& environment, BusSession& session, BoardSource& source);

}  // namespace asip::cli
