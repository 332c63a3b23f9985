// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "asip/bus/registry/answer.hpp"
#include "cli/text/table.hpp"

namespace asip::cli {

/// One change of the catalogue, as `asipctl events` prints it.
bus::HistoryItem change_of(const bus::ChangeEvent& event);

Table change_table();
std::vector<Cell> change_row(const bus::HistoryItem& change);
/// Names that a template may use: members of bus::to_json(HistoryItem).
std::vector<std::string> change_fields();

}  // namespace asip::cli
