#pragma once
#include <iosfwd>
#include <string>
#include <vector>

namespace asip::cli {

/// The whole program: reads arguments, environment and configuration file, runs the subcommand, and returns
/// the exit status.
int run_app(int argc, const char* const* argv, std::istream& in, std::ostream& out, std::ostream& err);

/// `arguments` with numbers such as -100 marked, so that they are not taken for options; unmark() takes the
/// mark off.
std::vector<std::string> mark_negative_numbers(int argc, const char* const* argv);
void unmark(std::string& argument);

}  // namespace asip::cli
