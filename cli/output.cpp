#include "cli/output.hpp"

#include <CLI/CLI.hpp>
#include <map>
#include <string>

namespace asip::cli {
namespace {

const char* name_of(Output output) {
    switch (output) {
        case Output::kTable:
            return "table";
        case Output::kWide:
            return "wide";
        case Output::kText:
            return "text";
        case Output::kJson:
            return "json";
        case Output::kJsonLines:
            return "jsonl";
        case Output::kName:
            return "name";
    }
    return "";
}

}  // namespace

void add_output_option(CLI::App& command, Output& output, const std::vector<Output>& forms) {
    std::map<std::string, Output> names;
    std::string list;
    for (const auto form : forms) {
        names.emplace(name_of(form), form);
        list += (list.empty() ? "" : "|") + std::string(name_of(form));
    }
    const auto take = [&output, names, list](const std::vector<std::string>& words) {
        const auto found = names.find(words.front());
        if (found == names.end())
            throw CLI::ValidationError("--output", words.front() + " is none of " + list);
        output = found->second;
        return true;
    };
    command.add_option("-o,--output", take, "Form of the output, by default " + std::string(name_of(output)))
        ->type_name(list)
        ->expected(1);
}

}  // namespace asip::cli
