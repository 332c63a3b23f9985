// SPDX-License-Identifier: Apache-2.0
#include "cli/secure/report.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <ostream>

namespace asip::cli {

void SecureReport::did(const std::string& action, const std::string& what, const std::string& file) {
    changed_ = changed_ || (action != "kept" && action != "warning");
    if (options_.for_people())
        out_ << fmt::format("{:<8} {}{}{}\n", action, what, file.empty() ? "" : ": ", file);
    else
        records_.print({{"action", action}, {"what", what}, {"file", file}});
}

void SecureReport::next(const std::string& why, const std::string& command) {
    if (options_.for_people())
        next_ += "  " + why + (command.empty() ? "" : ":\n      " + command) + "\n";
    else
        records_.print({{"action", "next"}, {"what", why}, {"command", command}});
}

void SecureReport::finish() {
    if (options_.for_people()) {
        if (!next_.empty()) out_ << "\nNext:\n" << next_;
        out_ << std::flush;
    } else {
        records_.finish();
    }
}

}  // namespace asip::cli
