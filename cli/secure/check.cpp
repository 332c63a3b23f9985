// SPDX-License-Identifier: Apache-2.0
#include "cli/secure/check.hpp"
#include "cli/secure/sources.hpp"

#include <nlohmann/json.hpp>
#include <ostream>

#include "asip/random.hpp"
#include "cli/secure/actions.hpp"
#include "cli/secure/leftovers.hpp"
#include "cli/secure/secrets.hpp"
#include "cli/secure/try_out.hpp"
#include "cli/secure/users.hpp"
#include "cli/text/table.hpp"

namespace asip::cli {
namespace {

std::string_view name_of(Found found) {
    switch (found) {
        case Found::kAllowed:
            return "allowed";
        case Found::kDenied:
            return "denied";
        case Found::kPartly:
            return "partly";
        case Found::kUnknown:
            break;
    }
    return "not tried";
}

class Checker {
  public:
    Checker(const SecureOptions& options, Environment& environment)
        : options_(options),
          environment_(environment),
          records_(options.output, RecordPrinter::Count::kList, environment.out) {}

    void row(const Trial& trial, Found found, const std::string& role) {
        const auto wanted = trial.allowed ? Found::kAllowed : Found::kDenied;
        if (found != Found::kUnknown && found != wanted) ++wrong_;
        if (options_.output.for_people()) {
            const auto colour = found == wanted            ? Colour::kGreen
                                : found == Found::kUnknown ? Colour::kYellow
                                                           : Colour::kRed;
            table_.add({trial.user.empty() ? "(no user)" : trial.user, role, trial.what,
                        std::string(name_of(wanted)), Cell(std::string(name_of(found)), colour)});
        } else {
            records_.print({{"name", trial.user},
                            {"role", role},
                            {"what", trial.what},
                            {"should", name_of(wanted)},
                            {"is", name_of(found)}});
        }
    }

    int finish() {
        if (options_.output.for_people())
            environment_.out << table_.render(environment_.width, environment_.colour) << std::flush;
        else
            records_.finish();
        if (wrong_ == 0) return program::kExitOk;
        environment_.note(
            "the broker does not do what it should: has it read its files? Reload it: asipctl secure show "
            "names them");
        return program::kExitFailure;
    }

  private:
    const SecureOptions& options_;
    Environment& environment_;
    RecordPrinter records_;
    Table table_{{{"NAME"}, {"ROLE"}, {"WHAT", false, 12}, {"SHOULD BE"}, {"IS"}}};
    std::size_t wrong_ = 0;
};

Outcome<void> check_strangers(Checker& checker, const mqtt::Options& admin, Duration limit) {
    auto nobody = admin;
    nobody.user.clear();
    nobody.password.clear();
    auto guesser = admin;
    guesser.password = random_password();
    for (auto& [options, what] :
         {std::pair{nobody, "connect without user"}, std::pair{guesser, "connect with a wrong password"}}) {
        const auto accepted = accepts(options, limit);
        if (!accepted) return tl::unexpected(accepted.error());
        checker.row({options.user, what, false, {}, {}}, *accepted ? Found::kAllowed : Found::kDenied, "");
    }
    return {};
}

}  // namespace

Outcome<int> secure_check(const SecureOptions& options, Environment& environment) {
    std::optional<SecuredBus> bus;
    std::optional<mqtt::Options> admin;
    std::vector<std::pair<SecuredUser, Outcome<mqtt::Options>>> users;
    {
        const auto folder = SecureFolder::open(secure_folder(options));
        if (!folder) return tl::unexpected(folder.error());
        auto read = folder->bus();
        if (!read) return tl::unexpected(read.error());
        bus = std::move(*read);
        if (!options.what.empty()) {
            if (auto known = check_known(*bus, options.what); !known) return tl::unexpected(known.error());
        }
        auto found = options_of(*folder, "admin");
        if (!found) return tl::unexpected(found.error());
        admin = std::move(*found);
        for (const auto& user : bus->users)
            if (options.what.empty() || options.what == user.name)
                users.emplace_back(user, options_of(*folder, user.name));
    }
    const auto stranger = "asip-check-" + random_hex(system_random(), 12);
    Checker checker(options, environment);
    if (options.what.empty()) {
        if (auto done = check_strangers(checker, *admin, environment.timeout); !done)
            return tl::unexpected(done.error());
    }
    for (const auto& [user, own] : users) {
        auto trials = trials_of(user.with_rights(), bus->topic_root, stranger);
        if (user.role == Role::kBoard)
            for (auto& each : source_trials(*bus, user.name, stranger))
                trials.push_back(std::move(each));
        Outcome<std::vector<Found>> found = std::vector<Found>(trials.size(), Found::kUnknown);
        if (own) found = try_out(trials, *own, *admin, bus->topic_root, 2 * environment.timeout);
        if (!found) return tl::unexpected(found.error());
        for (std::size_t i = 0; i < trials.size(); ++i)
            checker.row(trials[i], (*found)[i], std::string(name_of(user.role)));
    }
    return checker.finish();
}

}  // namespace asip::cli
