// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "asip/bus/registry/items.hpp"
#include "asip/bus/registry/query.hpp"
#include "cli/environment.hpp"
#include "cli/find/chosen_boards.hpp"
#include "cli/output.hpp"
#include "cli/text/table.hpp"

namespace asip::cli {

struct ListOptions {
    std::string what = "boards";  ///< or `services`
    bus::Query query{};
    SelectorText selector{};
    std::string sort = "name";  ///< name, state, chip, sketch, kind or announced
    bool reverse = false;
    OutputOptions output{Output::kTable, {}};

    bool services() const { return what == "services"; }
};

/// `asipctl list`: boards or services.
int run_list(const ListOptions& options, Environment& environment);

/// The columns of one kind of list, and a row of it.
Table board_table(bool wide);
void add_board(Table& table, const bus::BoardItem& board, bool wide);
Table service_table(bool wide);
std::vector<Cell> service_row(const bus::ServiceItem& service, bool wide);

/// A whole list in one of the forms for people, ended by a newline unless it is empty.
std::string boards_text(const std::vector<bus::BoardItem>& boards, Output output, std::size_t width,
                        bool colour);
/// The same, for the forms that brief rows suffice for: kTable and kName.
std::string brief_text(const bus::BriefRows& boards, Output output, std::size_t width, bool colour);
std::string services_text(const std::vector<bus::ServiceItem>& services, Output output, std::size_t width,
                          bool colour);

/// Sorts by a word of ListOptions::sort; what has no such member, or the same value, stays in the order of
/// names.
void sort_list(bus::BriefRows& boards, const std::string& by, bool reverse);
void sort_list(std::vector<bus::BoardItem>& boards, const std::string& by, bool reverse);
void sort_list(std::vector<bus::ServiceItem>& services, const std::string& by, bool reverse);

Colour state_colour(std::string_view state);
/// The state of a board with its reason. A port where nothing has ever answered was never there to be lost.
Cell state_cell(const bus::BriefBoard& board);

}  // namespace asip::cli
