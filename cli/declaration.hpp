// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "cli/output.hpp"
#include "cli/verb.hpp"

namespace CLI {
class App;
}

namespace asip::cli {

/// Takes the declaration of one verb: its arguments, options and forms of output. Values are written when the
/// command line is parsed; they must live as long as the verb's Run.
///
/// `type` is what help shows and what completion offers by: `BOARD`, `PATTERN` (of boards), `BOARD/SERVICE`,
/// `BOARD[/SERVICE]`, `BOARD[/SERVICE[/FIELD]]`, `COMMAND` (of the service that is the first argument),
/// `KIND`, `UNIT`, `VERB`, `FILE`, `DIR`, or the words themselves: `high|low`. With words, others are refused
/// unless
/// `...` is one of them. Any other type is free text.
class Declaration {
  public:
    explicit Declaration(CLI::App& command) : command_(command) {}

    enum class Needed { kYes, kNo };

    /// In the order of their declaration.
    void argument(const std::string& type, std::string& value, const std::string& help,
                  Needed needed = Needed::kYes);
    /// All that are left.
    void arguments(const std::string& type, std::vector<std::string>& values, const std::string& help,
                   Needed needed = Needed::kYes);

    /// `names`: `-w,--watch`.
    void flag(const std::string& names, bool& value, const std::string& help);
    void option(const std::string& names, const std::string& type, std::string& value,
                const std::string& help);
    /// Nothing: not given, which is not empty.
    void option(const std::string& names, const std::string& type, std::optional<std::string>& value,
                const std::string& help);
    /// With commas or repeated.
    void option(const std::string& names, const std::string& type, std::vector<std::string>& values,
                const std::string& help);
    void option(const std::string& names, const std::string& type, std::size_t& value,
                const std::string& help, std::size_t least = 0,
                std::size_t greatest = std::numeric_limits<std::size_t>::max());
    void option(const std::string& names, const std::string& type, std::optional<std::size_t>& value,
                const std::string& help);
    /// Bounds are included.
    void option(const std::string& names, const std::string& type, double& value, const std::string& help,
                double least, double greatest);
    /// `500ms`, `10s`, `7d`.
    void option(const std::string& names, std::chrono::milliseconds& value, const std::string& help,
                std::chrono::milliseconds least = std::chrono::milliseconds(0));
    void option(const std::string& names, std::optional<std::chrono::milliseconds>& value,
                const std::string& help);

    /// `-o` with `forms` for people (first the default), `json` and `jsonl`, and `--format` with the members
    /// `fields` of records.
    void output(OutputOptions& options, const std::vector<Output>& forms,
                const std::vector<std::string>& fields);

  private:
    CLI::App& command_;
};

}  // namespace asip::cli
