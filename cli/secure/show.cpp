// SPDX-License-Identifier: Apache-2.0
#include "cli/secure/show.hpp"

#include <nlohmann/json.hpp>
#include <ostream>

#include "asip/text/file_text.hpp"
#include "asip/text/wall_time.hpp"
#include "cli/secure/actions.hpp"
#include "cli/secure/users.hpp"
#include "cli/text/table.hpp"

namespace asip::cli {
namespace {

constexpr auto kSoon = std::chrono::days(60);

std::string day_of(const std::string& iso_time) {
    return iso_time.substr(0, 10);
}

/// One row of the table: a user, or the broker.
struct Row {
    std::string name, role, since, until, file, rights;
};

Row row_of(const SecureFolder& folder, const SecuredUser& user) {
    const auto file = folder.credentials(user.name);
    return {user.name,
            std::string(name_of(user.role)),
            user.made,
            {},
            std::filesystem::exists(file) ? file.string() : std::string(),
            std::string(rights_of(user.role))};
}

Row broker_row(const SecureFolder& folder, const SecuredBus& bus, Environment& environment) {
    std::string hosts;
    for (const auto& host : bus.hosts)
        hosts += (hosts.empty() ? "" : " ") + mqtt::BrokerAddress{host, bus.port, true}.describe();
    Row row{"broker", "broker", {}, {}, folder.certificate().string(), hosts};
    const auto text = text::file_text(folder.certificate());
    const auto end = text ? end_of(*text) : Expected<CertificateTime>(fail("it cannot be read"));
    if (!end) {
        environment.note(folder.certificate().string() + ": " + end.error() +
                         "; asipctl secure init makes one");
        return row;
    }
    row.until = text::iso_time(std::chrono::system_clock::time_point(*end));
    if (*end - std::chrono::system_clock::now() < kSoon)
        environment.note("the broker's certificate ends on " + day_of(row.until) +
                         "; a new one: asipctl secure renew broker");
    return row;
}

}  // namespace

Outcome<void> secure_show(const SecureOptions& options, Environment& environment) {
    const auto folder = SecureFolder::open(secure_folder(options));
    if (!folder) return tl::unexpected(folder.error());
    const auto bus = folder->bus();
    if (!bus) return tl::unexpected(bus.error());
    std::vector<Row> rows;
    if (options.what.empty())
        rows.push_back(broker_row(*folder, *bus, environment));
    else if (auto known = check_known(*bus, options.what); !known)
        return known;
    for (const auto& user : bus->users)
        if (options.what.empty() || user.name == options.what) rows.push_back(row_of(*folder, user));
    Table table({{"NAME"}, {"ROLE"}, {"SINCE"}, {"UNTIL"}, {"CREDENTIALS HERE"}, {"MAY", false, 20}});
    RecordPrinter records(options.output, RecordPrinter::Count::kList, environment.out);
    for (const auto& row : rows) {
        if (options.output.for_people()) {
            table.add({row.name, row.role, day_of(row.since), day_of(row.until),
                       row.role == "broker" ? ""
                       : row.file.empty()   ? "no"
                                            : "yes",
                       row.rights});
        } else {
            records.print({{"name", row.name},
                           {"role", row.role},
                           {"since", row.since},
                           {"until", row.until},
                           {"file", row.file},
                           {"may", row.rights}});
        }
    }
    if (options.output.for_people())
        environment.out << table.render(environment.width, environment.colour) << std::flush;
    else
        records.finish();
    return {};
}

}  // namespace asip::cli
