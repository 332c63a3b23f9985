// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>
#include <ostream>

#include "asip/text/nearest.hpp"
#include "asip/text/printable.hpp"
#include "cli/ask/board_source.hpp"
#include "cli/declaration.hpp"
#include "cli/find/target.hpp"
#include "cli/text/moment.hpp"
#include "cli/text/table.hpp"

namespace asip::cli {
namespace {

struct ValuesOptions {
    std::string target;
    std::string since = "1d";
    std::string until;  ///< empty: now
    std::size_t points = 500;
    OutputOptions output{Output::kTable, {}};
};

Outcome<text::WallTime> moment_of(const char* option, const std::string& text, text::WallTime now) {
    const auto moment = parse_moment(text, now);
    if (!moment) return failure(program::kExitUsage, std::string(option) + ": " + moment.error());
    return *moment;
}

std::string csv_cell(std::string text) {
    for (auto at = text.find('"'); at != std::string::npos; at = text.find('"', at + 2))
        text.insert(at, 1, '"');
    return '"' + text + '"';
}

/// What a registry kept of one property, or the list of those of which it keeps something.
class KeptValues : OnTheBus {
  public:
    KeptValues(const ValuesOptions& options, Environment& environment)
        : OnTheBus(environment), options_(options) {}

    int run() {
        const auto slash = options_.target.find('/');
        query_.board = options_.target.substr(0, slash);
        if (const auto valid = check_board_pattern(query_.board, "values"); !valid)
            return environment_.fail_with(valid.error());
        if (slash != std::string::npos && query_.board.find_first_of("*?") != std::string::npos)
            return environment_.fail_with(
                {program::kExitUsage, "values: a property is of one board; a pattern lists what is kept"});
        const auto now = text::wall_now();
        const auto from = moment_of("--since", options_.since, now);
        if (!from) return environment_.fail_with(from.error());
        const auto to = options_.until.empty() ? now : moment_of("--until", options_.until, now);
        if (!to) return environment_.fail_with(to.error());
        if (*from >= *to)
            return environment_.fail_with({program::kExitUsage, "--since is not before --until"});
        if (const auto status = connect()) return *status;
        const auto kept = source_.values(query_);
        if (!kept) return environment_.fail_with(kept.error());
        if (slash == std::string::npos) return list(kept->kept);
        const auto id = property_of(options_.target.substr(slash + 1), kept->kept);
        if (!id) return environment_.fail_with(id.error());
        query_.property = *id;
        query_.from = *from;
        query_.to = *to;
        query_.limit = options_.points;
        const auto answer = source_.values(query_);
        if (!answer) return environment_.fail_with(answer.error());
        print(*answer);
        return program::kExitOk;
    }

  private:
    /// As it is, or the only one of a service.
    Outcome<std::string> property_of(const std::string& wanted, const std::vector<bus::KeptProperty>& kept) {
        std::vector<std::string> ids, below;
        for (const auto& each : kept) {
            if (each.property == wanted) return wanted;
            ids.push_back(each.property);
            if (each.property.starts_with(wanted + "/")) below.push_back(each.property);
        }
        if (below.size() == 1) return below.front();
        auto why = "nothing is kept of " + options_.target + text::did_you_mean(wanted, ids);
        if (below.size() > 1) why = options_.target + " has several: asipctl values " + query_.board;
        if (ids.empty()) why += "; a property with a name is kept: asipctl label";
        return failure(program::kExitFailure, text::printable(why));
    }

    bool is_csv() const { return options_.output.form == Output::kCsv && options_.output.format.empty(); }

    int list(const std::vector<bus::KeptProperty>& kept) {
        if (is_csv()) {
            environment_.out << "board,property\n";
            for (const auto& each : kept)
                environment_.out << each.board << ',' << csv_cell(each.property) << '\n';
            environment_.out << std::flush;
            return program::kExitOk;
        }
        RecordPrinter records(options_.output, RecordPrinter::Count::kList, environment_.out);
        Table table({{"BOARD"}, {"PROPERTY"}});
        for (const auto& each : kept)
            if (options_.output.for_people())
                table.add({each.board, each.property});
            else
                records.print({{"board", each.board}, {"property", each.property}});
        if (!options_.output.for_people())
            records.finish();
        else if (table.empty())
            environment_.note("nothing is kept of it; a property with a name is: asipctl label");
        else
            environment_.out << table.render(environment_.width, environment_.colour) << std::flush;
        return program::kExitOk;
    }

    void print(const bus::Answer& answer) {
        RecordPrinter records(options_.output, RecordPrinter::Count::kList, environment_.out);
        Table table({{"AT"}, {"MEAN", true}, {"MIN", true}, {"MAX", true}});
        const bool csv = is_csv();
        if (csv) environment_.out << "at,mean,min,max\n";
        for (const auto& point : answer.values) {
            const auto at = text::iso_time(point.at);
            const auto number = [&](double value) {
                return point.known ? nlohmann::json(value).dump() : std::string();
            };
            if (csv) {
                environment_.out << at << ',' << number(point.mean) << ',' << number(point.min) << ','
                                 << number(point.max) << '\n';
            } else if (options_.output.for_people()) {
                table.add({at, point.known ? number(point.mean) : "-", number(point.min), number(point.max)});
            } else {
                nlohmann::json record{{"at", at}, {"mean", nullptr}};
                if (point.known)
                    record.update({{"mean", point.mean}, {"min", point.min}, {"max", point.max}});
                records.print(record);
            }
        }
        environment_.out << std::flush;
        if (!options_.output.for_people()) return records.finish();
        if (csv) return;
        if (table.empty()) return environment_.note("nothing was known of it in that time");
        environment_.out << table.render(environment_.width, environment_.colour) << std::flush;
    }

    const ValuesOptions& options_;
    bus::Query query_;
};

Run declare_values(Declaration& verb) {
    auto options = std::make_shared<ValuesOptions>();
    verb.argument("BOARD[/SERVICE[/FIELD]]", options->target,
                  "A property, such as desk/temperature; a board alone lists what is kept of it");
    verb.option("--since", "WHEN", options->since, "How long ago (2d), or a time in UTC; 1d");
    verb.option("--until", "WHEN", options->until, "The same; now");
    verb.option("--points", "COUNT", options->points, "At most so many; each stands for an equal time", 1,
                bus::Query::kMaxPage);
    verb.output(options->output, {Output::kTable, Output::kCsv},
                {"at", "mean", "min", "max", "board", "property"});
    return [options](Environment& environment) { return KeptValues(*options, environment).run(); };
}

}  // namespace

Verb values_verb() {
    return {"values", "How a property was: what a registry kept of hours, days and weeks",
            "Kept are properties with a name, those on a dashboard, and those that the registry's `values` "
            "names.\n"
            "A point holds until the next; one without numbers begins a gap.\n"
            "Examples:\n"
            "  asipctl values desk\n"
            "  asipctl values desk/temperature --since 2d\n"
            "  asipctl values desk/distance/0 --since 2026-11-21 --points 50\n"
            "  asipctl values desk/temperature --since 7d -o csv > week.csv",
            declare_values};
}

}  // namespace asip::cli
