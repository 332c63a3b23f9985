// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "asip/bus/registry/items.hpp"
#include "asip/bus/registry/query.hpp"
#include "cli/environment.hpp"
#include "cli/find/target.hpp"
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

int run_list(const ListOptions& options, Environment& environment);

/// Columns of a list, and a row.
Table board_table(bool wide);
void add_board(Table& table, const bus::BoardItem& board, bool wide);
Table service_table(bool wide);
std::vector<Cell> service_row(const bus::ServiceItem& service, bool wide);

/// For people, ended by a newline unless it is empty.
std::string boards_text(const std::vector<bus::BoardItem>& boards, Output output, std::size_t width,
                        bool colour);
/// For kTable and kName.
std::string brief_text(const bus::BriefRows& boards, Output output, std::size_t width, bool colour);
std::string services_text(const std::vector<bus::ServiceItem>& services, Output output, std::size_t width,
                          bool colour);

/// By a word of ListOptions::sort; equal ones, and those without the member, stay by name.
void sort_list(bus::BriefRows& boards, const std::string& by, bool reverse);
void sort_list(std::vector<bus::BoardItem>& boards, const std::string& by, bool reverse);
void sort_list(std::vector<bus::ServiceItem>& services, const std::string& by, bool reverse);

Colour state_colour(std::string_view state);
/// A port where nothing ever answered was never lost.
Cell state_cell(const bus::BriefBoard& board);

}  // namespace asip::cli
