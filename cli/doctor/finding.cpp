// SPDX-License-Identifier: Apache-2.0
#include "cli/doctor/finding.hpp"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>

#include "cli/text/table.hpp"
#include "cli/text/width.hpp"

namespace asip::cli {
namespace {

struct LevelWord {
    const char* word;
    Colour colour;
};

const LevelWord& word_of(Finding::Level level) {
    static constexpr std::array kWords{LevelWord{"ok", Colour::kGreen}, LevelWord{"note", Colour::kYellow},
                                       LevelWord{"problem", Colour::kRed}};
    return kWords[static_cast<std::size_t>(level)];
}

}  // namespace

Finding fine(std::string what) {
    return {Finding::Level::kFine, std::move(what), {}};
}
Finding note(std::string what, std::string advice) {
    return {Finding::Level::kNote, std::move(what), std::move(advice)};
}
Finding problem(std::string what, std::string advice) {
    return {Finding::Level::kProblem, std::move(what), std::move(advice)};
}

bool has_problem(const Findings& findings) {
    return std::any_of(findings.begin(), findings.end(),
                       [](const Finding& finding) { return finding.level == Finding::Level::kProblem; });
}

std::string findings_text(const Findings& findings, bool colour) {
    std::string text;
    for (const auto& finding : findings) {
        std::string word = word_of(finding.level).word;
        word.resize(8, ' ');
        text +=
            painted(word, word_of(finding.level).colour, colour) + " " + for_terminal(finding.what) + "\n";
        if (!finding.advice.empty()) text += "         -> " + for_terminal(finding.advice) + "\n";
    }
    return text;
}

nlohmann::json finding_json(const Finding& finding) {
    nlohmann::json object{{"level", word_of(finding.level).word}, {"what", finding.what}};
    if (!finding.advice.empty()) object["advice"] = finding.advice;
    return object;
}

}  // namespace asip::cli
