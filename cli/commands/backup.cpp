// SPDX-License-Identifier: Apache-2.0
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <ostream>

#include "asip/text/wall_time.hpp"
#include "cli/ask/retained.hpp"
#include "cli/backup/machine.hpp"
#include "cli/backup/sealed.hpp"
#include "cli/declaration.hpp"
#include "cli/secure/report.hpp"
#include "cli/text/words.hpp"

namespace asip::cli {
namespace {

namespace fs = std::filesystem;

struct BackupOptions {
    std::string file, passphrase_file;
    BackupPaths paths;
    bool without_secrets = false, without_dashboards = false;
    OutputOptions output{};
};

/// One `asipctl backup`.
class Backup {
  public:
    Backup(const BackupOptions& options, Environment& environment)
        : options_(options), environment_(environment) {}

    Outcome<void> run() {
        const auto machine = BackupMachine::open(options_.paths);
        if (!machine) return tl::unexpected(machine.error());
        if (const auto read = read_files(*machine); !read) return read;
        if (const auto read = options_.without_dashboards ? Outcome<void>() : read_dashboards(); !read)
            return read;
        if (items_.empty())
            return failure(program::kExitFailure, "there is nothing to keep in " + options_.paths.etc +
                                                      " and " + options_.paths.state);
        Passphrase passphrase;
        const bool secrets =
            std::any_of(items_.begin(), items_.end(), [](const auto& item) { return item.is_secret(); });
        if (secrets || !options_.passphrase_file.empty()) {
            auto read = read_passphrase(options_.passphrase_file, true, environment_);
            if (!read) return tl::unexpected(read.error());
            passphrase = std::move(*read);
        }
        if (const auto written = write(passphrase); !written) return written;
        SecureReport report(options_.output, environment_);
        report.did("made",
                   counted(items_.size(), "item") +
                       (secrets ? ", with keys and users" : ", without keys and users") +
                       (passphrase.given ? "" : "; without a passphrase, so nothing proves who made it"),
                   options_.file);
        report.finish();
        return {};
    }

  private:
    Outcome<void> read_files(const BackupMachine& machine) {
        const auto left_out = [this](const std::string& why) { environment_.note("left out: " + why); };
        auto items = machine.list(left_out);
        if (!items) return tl::unexpected(items.error());
        std::size_t secrets = 0;
        for (auto& item : *items) {
            if (options_.without_secrets && item.is_secret()) {
                ++secrets;
                continue;
            }
            auto why = add_file(machine, item);
            if (!why) return tl::unexpected(why.error());
            if (!why->empty()) left_out(machine.name_of(item) + *why);
        }
        if (secrets > 0) left_out(counted(secrets, "file") + " with keys and users");
        return {};
    }

    /// Else why it is left out.
    Outcome<std::string> add_file(const BackupMachine& machine, BackupItem& item) {
        const std::string gone = " was removed meanwhile";
        if (item.is_database()) {
            const auto copy = machine.copy_database(item);
            const auto there = copy ? std::nullopt : std::optional(machine.look(item));
            if (there && *there && !**there) return gone;
            if (!copy) return tl::unexpected(copy.error());
            item.size = static_cast<std::uint64_t>(::lseek(copy->number(), 0, SEEK_END));
            item.changed =
                std::chrono::duration_cast<std::chrono::nanoseconds>(text::wall_now().time_since_epoch())
                    .count();
            if (!each_part(*copy, 0, item.size, [this](auto part) { return contents_.write(part); }))
                return no_room();
        } else {
            const auto text = machine.read(item);
            if (!text) return tl::unexpected(text.error());
            if (!*text) return gone;
            if ((*text)->size() > kMaxFileBytes) return " is above 1 MiB";
            item.size = (*text)->size();
            if (!contents_.write(**text)) return no_room();
        }
        items_.push_back(item);
        return "";
    }

    static tl::unexpected<Failure> no_room() {
        return failure(program::kExitFailure, std::string("no room in /var/tmp: ") + std::strerror(errno));
    }

    Outcome<void> read_dashboards() {
        BusSession session(environment_);
        const auto above = environment_.topics.root() + "/export/dashboard/";
        auto connected = session.connect();
        if (!connected) {
            connected.error().text += "; without it: --no-dashboards";
            return connected;
        }
        auto retained = read_retained(environment_, session, {above + "+"});
        if (!retained) return tl::unexpected(retained.error());
        for (auto& [topic, payload, expiry] : *retained) {
            BackupItem item{Place::kDashboard, topic.substr(above.size())};
            item.size = payload.size();
            if (!item.valid()) continue;
            if (!contents_.write(payload)) return no_room();
            items_.push_back(std::move(item));
        }
        return {};
    }

    Outcome<void> produce(const Sink& sink) {
        const auto text = to_text("made on " + program::host_name() + " at " +
                                      text::iso_time(text::wall_now()) + " by asipctl " ASIP_VERSION,
                                  items_);
        if (text.size() > kMaxListBytes || items_.size() > kMaxItems)
            return failure(program::kExitFailure,
                           "these are too many files: at most " + std::to_string(kMaxItems) + " are kept");
        const auto bytes = static_cast<std::uint64_t>(::lseek(contents_.number(), 0, SEEK_END));
        if (!sink(text) || !each_part(contents_, 0, bytes, sink)) return no_room();
        return {};
    }

    Outcome<void> write(const Passphrase& passphrase) {
        std::string draft = options_.file + ".XXXXXX";
        const Descriptor out(::mkostemp(draft.data(), O_CLOEXEC));  // 0600
        const auto cannot = [this] {
            return failure(program::kExitFailure,
                           "cannot write " + options_.file + ": " + std::strerror(errno));
        };
        if (!out.valid()) return cannot();
        auto done = seal(out, passphrase, [this](const Sink& sink) { return produce(sink); });
        if (done && ::rename(draft.c_str(), options_.file.c_str()) != 0) done = cannot();
        if (!done) ::unlink(draft.c_str());
        const auto above = fs::absolute(options_.file).parent_path();
        const Descriptor folder(::open(above.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
        if (done && (!folder.valid() || !folder.sync())) return cannot();
        return done;
    }

    const BackupOptions& options_;
    Environment& environment_;
    std::vector<BackupItem> items_;
    Descriptor contents_ = nameless_file();  // in their order
};

Run declare_backup(Declaration& verb) {
    auto options = std::make_shared<BackupOptions>();
    verb.argument("FILE", options->file, "What is made; an older one of that name goes");
    verb.option("--passphrase-file", "FILE", options->passphrase_file,
                "Its first line is the passphrase (-: standard input); default: it is asked for");
    verb.flag("--no-secrets", options->without_secrets,
              "Leave out keys, users, and all that other users of the machine may not read");
    verb.flag("--no-dashboards", options->without_dashboards, "Leave out dashboards: no broker is asked");
    declare_paths(verb, options->paths);
    verb.output(options->output, {Output::kText}, {"action", "what", "file"});
    return [options](Environment& environment) {
        const auto done = Backup(*options, environment).run();
        return done ? program::kExitOk : environment.fail_with(done.error());
    };
}

}  // namespace

void declare_paths(Declaration& verb, BackupPaths& paths) {
    verb.option("--etc", "DIR", paths.etc, "Configuration; default: /etc/asip");
    verb.option("--state", "DIR", paths.state, "What the services keep; default: /var/lib/asip");
    verb.option("--mosquitto", "DIR", paths.mosquitto,
                "Configuration of the broker; default: /etc/mosquitto/conf.d");
}

Verb backup_verb() {
    return {
        "backup", "Keep all of this machine's bus in one file",
        "Keys and users, tokens, configuration, labels, links, stops, values, history; and the dashboards, "
        "which the broker\nhas. A passphrase encrypts all of it and proves that nobody changed it. The "
        "services may run meanwhile.\n"
        "asipctl restore brings it back, also on another machine. Labels and links of boards on other "
        "machines are there.\n"
        "Examples:\n"
        "  asipctl backup bus.backup\n"
        "  asipctl backup bus.backup --passphrase-file /root/passphrase\n"
        "  asipctl backup labels.backup --no-secrets",
        declare_backup};
}

}  // namespace asip::cli
