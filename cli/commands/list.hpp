#pragma once
#include <string>
#include <vector>

#include "asip/bus/items.hpp"
#include "asip/bus/query.hpp"
#include "cli/context.hpp"
#include "cli/output.hpp"
#include "cli/text/table.hpp"

namespace asip::cli {

struct ListOptions {
    bool services = false;
    bus::Query query{};
    bool watch = false;
    Output output = Output::kTable;
};

/// `asipctl list`: boards or services, once or until Ctrl-C.
int run_list(const ListOptions& options, Context& context);

/// The columns of one kind of list, and a row of it.
Table board_table(bool wide);
std::vector<Cell> board_row(const bus::BoardItem& board, bool wide);
std::vector<Cell> brief_row(const bus::BriefBoard& board);
Table service_table(bool wide);
std::vector<Cell> service_row(const bus::ServiceItem& service, bool wide);

/// A whole list as text, ended by a newline unless it is empty.
std::string boards_text(const std::vector<bus::BoardItem>& boards, Output output, std::size_t width,
                        bool colour);
/// The same, for the forms that brief rows suffice for: kTable and kName.
std::string brief_text(const std::vector<bus::BriefBoard>& boards, Output output, std::size_t width,
                       bool colour);
std::string services_text(const std::vector<bus::ServiceItem>& services, Output output, std::size_t width,
                          bool colour);

Colour state_colour(const std::string& state);

}  // namespace asip::cli
