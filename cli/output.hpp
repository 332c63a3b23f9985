#pragma once
#include <vector>

namespace CLI {
class App;
}

namespace asip::cli {

/// Forms of output: for people, and for programs.
enum class Output { kTable, kWide, kText, kJson, kJsonLines, kName };

/// Adds `-o,--output` to a command that knows these forms; the default is what `output` holds.
void add_output_option(CLI::App& command, Output& output, const std::vector<Output>& forms);

}  // namespace asip::cli
