// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/label.hpp"
#include "cli/declaration.hpp"
#include "cli/find/target.hpp"

namespace asip::cli {
namespace {

struct RenameOptions {
    std::string target;
    std::vector<std::string> words;
    bool remove = false;
    OutputOptions output{};
};

Failure wrong(std::string text) {
    return {program::kExitUsage, std::move(text)};
}

/// A name is a label of the board, or the friendly name of a service or a pin: all of them are kept as labels
/// are.
Outcome<LabelOptions> as_label(const RenameOptions& options) {
    const auto target = parse_target(options.target);
    if (!target) return tl::unexpected(target.error());
    auto words = options.words;
    std::optional<std::string> name;
    if (!options.remove) {
        if (words.empty())
            return tl::unexpected(wrong("call it what? Write asipctl rename " + options.target +
                                        " NAME, or --remove to take its name away"));
        name = std::move(words.back());
        words.pop_back();
        if (name->empty()) return tl::unexpected(wrong("a name is not empty; --remove takes it away"));
    }
    LabelOptions label;
    label.target = options.target;
    label.output = options.output;
    if (words.size() > 1)
        return tl::unexpected(wrong("one name; one with blanks stands in quotes: \"" + words.back() +
                                    (name ? " " + *name : "") + "\""));
    if (!words.empty() && !target->service.empty())
        return tl::unexpected(
            wrong("a pin is a board's: asipctl rename " + target->board + " " + words.front() + " NAME"));
    if (!words.empty()) {
        label.pin = words.front();
        label.pin_name = std::move(name);
    } else {
        label.words.push_back(name ? "name=" + *name : "name-");
    }
    return label;
}

Run declare_rename(Declaration& verb) {
    auto options = std::make_shared<RenameOptions>();
    verb.argument("BOARD[/SERVICE]", options->target, "Which");
    verb.arguments("NAME", options->words, "What to call it; with a pin before it: what to call that pin",
                   Declaration::Needed::kNo);
    verb.flag("--remove", options->remove, "Take the name away");
    verb.output(options->output, {Output::kTable}, kLabelFields);
    return [options](Environment& environment) {
        auto label = as_label(*options);
        return label ? run_label(std::move(*label), environment) : environment.fail_with(label.error());
    };
}

}  // namespace

Verb rename_verb() {
    return {
        "rename", "Friendly names of boards, of their services and pins",
        "A board is still known and addressed by its own name; views show the friendly one beside it. Names "
        "are kept\n"
        "as labels are (asipctl label): a board's is its label \"name\".\n"
        "Exit status: 0 kept, 1 refused, 4 no answer.\n"
        "Examples:\n"
        "  asipctl rename uno1 \"Ann's robot\"\n"
        "  asipctl rename uno1/servo \"left arm\"\n"
        "  asipctl rename uno1 13 \"status lamp\"\n"
        "  asipctl rename uno1 A0 light\n"
        "  asipctl rename uno1 \"status lamp\" --remove",
        declare_rename};
}

}  // namespace asip::cli
