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

/// kTable, kWide, kText, kName and kCsv are what a verb writes itself; each verb with data knows kJson and
/// kJsonLines.
enum class Output { kTable, kWide, kText, kName, kCsv, kJson, kJsonLines };

std::string_view name_of(Output output);

/// As the user chose.
struct OutputOptions {
    Output form = Output::kText;
    std::string format;  ///< a template that each record is printed by, instead of `form`; empty: none

    /// Text instead of records.
    bool for_people() const { return format.empty() && form != Output::kJson && form != Output::kJsonLines; }
};

/// Fails with the nearest name on a bad template or a name outside `fields`; of `data.distance.0` the part
/// before the first dot counts.
Expected<void> check_template(const std::string& text, const std::vector<std::string>& fields);

/// `services.0.name`; null: there is none.
const nlohmann::json* member_at(const nlohmann::json& value, std::string_view path);

/// A string as it is, anything else as JSON; may be empty.
std::string value_at(const nlohmann::json& value, std::string_view path);

/// Prints JSON objects in the chosen form, where OutputOptions::for_people() does not hold.
class RecordPrinter {
  public:
    enum class Count {
        kOne,    ///< exactly one record: `json` prints it alone
        kList,   ///< `json` prints an array, at the end
        kStream  ///< the number is unknown: `json` prints one after the other, indented
    };
    /// With checked options. Flushes after each record unless `count` is kList.
    RecordPrinter(const OutputOptions& options, Count count, std::ostream& out);

    void print(const nlohmann::json& record);
    /// Without it a list in the form `json` is not printed.
    void finish();

  private:
    OutputOptions options_;
    Count count_;
    std::ostream& out_;
    std::optional<LineTemplate> template_;
    nlohmann::json all_ = nlohmann::json::array();
};

struct Failure;

/// `board`, `status` (`error`, `timeout` or `refused`), `error`, and perhaps `reason` and `code`.
nlohmann::json failure_record(const std::string& board, const Failure& failure);
/// Where the user wants JSON; a template is for what succeeds.
void print_failure(const OutputOptions& options, RecordPrinter::Count count, const std::string& board,
                   const Failure& failure, std::ostream& out);

}  // namespace asip::cli
