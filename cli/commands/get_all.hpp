// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "asip/property/documents.hpp"
#include "cli/commands/get.hpp"
#include "cli/text/table.hpp"

namespace asip::cli {

/// `asipctl get BOARD`, with patterns and -l: the properties of the boards and how they stand.
int run_get_all(const GetOptions& options, Environment& environment);

/// One line of it: id, name, value, how it is known, age.
std::vector<Cell> value_row(const std::string& board, const property::Property& property,
                            const property::ShownValue& shown, bool raw);
/// The same for programs.
nlohmann::json value_record(const std::string& board, const property::Property& property,
                            const property::ShownValue& shown);
/// Says on standard error why a property cannot be set now, if so.
void note_refused(Environment& environment, const std::string& board, const property::Property& property);

}  // namespace asip::cli
