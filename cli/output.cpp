// SPDX-License-Identifier: Apache-2.0
#include "cli/output.hpp"

#include <algorithm>
#include <array>
#include <ostream>

#include "asip/model/json.hpp"
#include "asip/protocol/body.hpp"
#include "asip/text/nearest.hpp"
#include "asip/text/printable.hpp"
#include "cli/environment.hpp"
#include "cli/text/words.hpp"

namespace asip::cli {
namespace {

std::string_view first_part(std::string_view path) {
    return path.substr(0, path.find('.'));
}

}  // namespace

std::string_view name_of(Output output) {
    static constexpr std::array<std::string_view, 7> kNames{"table", "wide", "text", "name",
                                                            "csv",   "json", "jsonl"};
    return kNames.at(static_cast<std::size_t>(output));
}

Expected<void> check_template(const std::string& text, const std::vector<std::string>& fields) {
    const auto line = LineTemplate::parse(text);
    if (!line) return fail(line.error());
    for (const auto& name : line->names()) {
        const std::string first(first_part(name));
        if (std::find(fields.begin(), fields.end(), first) != fields.end()) continue;
        return fail("there is no {" + name + "}" + text::did_you_mean(first, fields) + "; there are " +
                    listed(fields));
    }
    return {};
}

const nlohmann::json* member_at(const nlohmann::json& value, std::string_view path) {
    const auto* at = &value;
    while (!path.empty()) {
        const std::string key(first_part(path));
        const auto index = protocol::parse_integer(key);
        if (at->is_object() && at->contains(key))
            at = &(*at)[key];
        else if (at->is_array() && index && *index >= 0 && static_cast<std::size_t>(*index) < at->size())
            at = &(*at)[static_cast<std::size_t>(*index)];
        else
            return nullptr;
        path.remove_prefix(std::min(key.size() + 1, path.size()));
    }
    return at;
}

std::string value_at(const nlohmann::json& value, std::string_view path) {
    const auto* at = member_at(value, path);
    if (at == nullptr) return {};
    return at->is_string() ? at->get<std::string>() : model::dump_json(*at);
}

RecordPrinter::RecordPrinter(const OutputOptions& options, Count count, std::ostream& out)
    : options_(options), count_(count), out_(out) {
    if (options_.format.empty()) return;
    if (auto line = LineTemplate::parse(options_.format)) template_ = std::move(*line);
}

void RecordPrinter::print(const nlohmann::json& record) {
    if (template_) {
        out_ << template_->fill([&record](std::string_view name) { return value_at(record, name); }) << '\n';
    } else if (options_.form != Output::kJson) {
        out_ << text::escape_json(model::dump_json(record)) << '\n';
    } else if (count_ == Count::kList) {
        all_.push_back(record);
        return;
    } else {
        out_ << text::escape_json(model::dump_json_pretty(record)) << '\n';
    }
    if (count_ != Count::kList) out_ << std::flush;
}

void RecordPrinter::finish() {
    const bool array = !template_ && options_.form == Output::kJson && count_ == Count::kList;
    if (array) out_ << text::escape_json(model::dump_json_pretty(all_)) << '\n';
    out_ << std::flush;
}

nlohmann::json failure_record(const std::string& board, const Failure& failure) {
    const auto* status = failure.code != 0                          ? "error"
                         : failure.status == program::kExitNoAnswer ? "timeout"
                                                                    : "refused";
    nlohmann::json record{{"board", board}, {"status", status}, {"error", failure.text}};
    if (!failure.reason.empty()) record["reason"] = failure.reason;
    if (failure.code != 0) record["code"] = failure.code;
    return record;
}

void print_failure(const OutputOptions& options, RecordPrinter::Count count, const std::string& board,
                   const Failure& failure, std::ostream& out) {
    if (options.for_people() || !options.format.empty()) return;
    RecordPrinter records(options, count, out);
    records.print(failure_record(board, failure));
    records.finish();
}

}  // namespace asip::cli
