// SPDX-License-Identifier: Apache-2.0
#include "registry/history/store.hpp"

#include <filesystem>
#include <system_error>

namespace asip::registry {
namespace {

namespace fs = std::filesystem;

constexpr int kMaxAside = 9;

}  // namespace

HistoryStore::Outcome HistoryStore::run(const Use& use) {
    if (!fault_.empty()) return {.fault = fault_, .opened = {}};
    Outcome outcome = attempt(use);
    fault_ = outcome.fault;
    return outcome;
}

HistoryStore::Outcome HistoryStore::attempt(const Use& use) {
    Outcome outcome;
    // A second time only where the first has found damage.
    for (int attempt = 0; attempt < 2; ++attempt) {
        try {
            if (!history_) open(outcome);
            use(*history_, outcome.opened ? &*outcome.opened : nullptr);
            outcome.fault.clear();
            return outcome;
        } catch (const HistoryFault& fault) {
            history_.reset();
            outcome.fault = fault.what();
            if (!fault.damaged) return outcome;
            const std::string aside = put_aside(options_.path);
            if (aside.empty()) {
                outcome.fault += ", and it cannot be put aside: move it";
                return outcome;
            }
            outcome.opened = Opened{.aside = aside, .damage = fault.what()};
        } catch (const std::exception& error) {
            history_.reset();
            outcome.fault = error.what();
            return outcome;
        }
    }
    return outcome;
}

void HistoryStore::open(Outcome& outcome) {
    std::error_code error;
    if (const auto type = fs::status(options_.path, error).type(); type == fs::file_type::directory)
        throw HistoryFault("it is a folder");
    history_ = std::make_unique<History>(options_);
    if (!outcome.opened) outcome.opened = Opened{};
    outcome.opened->boards = history_->boards();
    outcome.opened->mark = history_->mark();
    outcome.opened->made = !outcome.opened->mark && outcome.opened->boards.empty();
}

std::string put_aside(const std::string& path) {
    for (int number = 1; number <= kMaxAside; ++number) {
        const std::string aside = path + (number == 1 ? ".damaged" : ".damaged-" + std::to_string(number));
        std::error_code error;
        if (fs::exists(fs::symlink_status(aside, error))) continue;
        fs::rename(path, aside, error);
        if (error) return {};
        // They belong to it, and would spoil the new one.
        for (const char* part : {"-wal", "-shm"}) {
            fs::rename(path + part, aside + part, error);
            if (error) fs::remove(path + part, error);
        }
        return aside;
    }
    return {};
}

}  // namespace asip::registry
