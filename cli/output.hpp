// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <iosfwd>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "asip/expected.hpp"
#include "cli/text/line_template.hpp"

namespace asip::cli {

/// Forms of output. kTable, kWide, kText and kName are for people; each verb that prints data knows kJson and
/// kJsonLines too.
enum class Output { kTable, kWide, kText, kName, kJson, kJsonLines };

/// `table`, `wide`, `text`, `name`, `json`, `jsonl`.
std::string_view name_of(Output output);

/// How the user wants to see the data.
struct OutputOptions {
    Output form = Output::kText;
    std::string format;  ///< a template that each record is printed by, instead of `form`; empty: none

    /// Whether the verb prints text of its own instead of records.
    bool for_people() const { return format.empty() && form != Output::kJson && form != Output::kJsonLines; }
};

/// Fails with the nearest name when a template cannot be parsed or uses another name than `fields`; of a name
/// such as `data.distance.0` the part before the first dot counts.
Expected<void> check_template(const std::string& text, const std::vector<std::string>& fields);

/// The member of `value` that `path` leads to: `services.0.name`; null when there is none.
const nlohmann::json* member_at(const nlohmann::json& value, std::string_view path);

/// The same as text. A string as it is, anything else as JSON;
/// empty when there is none.
std::string value_at(const nlohmann::json& value, std::string_view path);

/// Prints records for programs: JSON objects, in the form that the user chose. Use it where
/// OutputOptions::for_people() does not hold.
class RecordPrinter {
  public:
    enum class Count {
        kOne,    ///< exactly one record: `json` prints it alone
        kList,   ///< `json` prints an array, at the end
        kStream  ///< the number is unknown: `json` prints one after the other, indented
    };
    /// The options must have been checked. Flushes after each record unless `count` is kList.
    RecordPrinter(const OutputOptions& options, Count count, std::ostream& out);

    void print(const nlohmann::json& record);
    /// After the last one. Without it, a list in the form `json` is not printed.
    void finish();

  private:
    OutputOptions options_;
    Count count_;
    std::ostream& out_;
    std::optional<LineTemplate> template_;
    nlohmann::json all_ = nlohmann::json::array();
};

struct Failure;

/// The record of a board that was not read or commanded, with the members of an answer: `board`, `status`
/// (`error`, `timeout` or `refused`), `error`, and `reason` and `code` where there are such.
nlohmann::json failure_record(const std::string& board, const Failure& failure);
/// Prints it where the user wants JSON; a template is for what succeeds.
void print_failure(const OutputOptions& options, RecordPrinter::Count count, const std::string& board,
                   const Failure& failure, std::ostream& out);

}  // namespace asip::cli
