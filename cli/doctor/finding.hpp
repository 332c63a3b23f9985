// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace asip::cli {

/// What is wrong (or fine), and what to do about it.
struct Finding {
    enum class Level { kFine, kNote, kProblem };
    Level level = Level::kFine;
    std::string what;
    std::string advice;  ///< empty for what is fine
    friend bool operator==(const Finding&, const Finding&) = default;
};
using Findings = std::vector<Finding>;

Finding fine(std::string what);
Finding note(std::string what, std::string advice);
Finding problem(std::string what, std::string advice);

bool has_problem(const Findings& findings);
/// One line each, advice below it.
std::string findings_text(const Findings& findings, bool colour);
/// `level` (ok, note or problem), `what`, and `advice` where there is any.
nlohmann::json finding_json(const Finding& finding);

}  // namespace asip::cli
