// SPDX-License-Identifier: Apache-2.0
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <istream>
#include <map>
#include <ostream>

#include "cli/ask/retained.hpp"
#include "cli/backup/machine.hpp"
#include "cli/backup/sealed.hpp"
#include "cli/declaration.hpp"
#include "cli/secure/broker_files.hpp"
#include "cli/secure/reload.hpp"
#include "cli/secure/services.hpp"
#include "cli/text/width.hpp"
#include "cli/text/words.hpp"

namespace asip::cli {
namespace {

namespace fs = std::filesystem;

struct RestoreOptions {
    std::string file, passphrase_file;
    BackupPaths paths;
    bool overwrite = false, yes = false, dry_run = false, dashboards = false;
    OutputOptions output{};
};

/// What becomes of an item here.
enum class What { kSame, kNew, kDiffers, kNewer };
constexpr std::array<const char*, 4> kWhatWords{"same", "new", "differs", "newer"};

/// One `asipctl restore`.
class Restore {
  public:
    Restore(const RestoreOptions& options, Environment& environment)
        : options_(options), environment_(environment), report_(options.output, environment) {}

    Outcome<void> run() {
        const auto machine = BackupMachine::open(options_.paths);
        if (!machine) return tl::unexpected(machine.error());
        if (auto done = open(); !done) return done;
        if (auto done = plan(*machine); !done) return done;
        const auto agreed = agree(*machine);
        if (!agreed) return tl::unexpected(agreed.error());
        if (!*agreed) return {};
        if (!to_write_.empty()) {
            auto done = write(*machine);
            if (done) done = take_up();
            if (!done) start_services();
            if (!done) return done;
        }
        const auto done = put_dashboards();
        report_.finish();
        return done;
    }

  private:
    void start_services() {
        if (!running_.empty()) order_units("start", running_, report_);
    }

    bool of_machine() const { return ::geteuid() == 0 && options_.paths.etc == BackupPaths().etc; }

    Outcome<void> open() {
        const auto sealed = unseal(
            options_.file, [this] { return read_passphrase(options_.passphrase_file, false, environment_); },
            text_);
        if (!sealed) return tl::unexpected(sealed.error());
        sealed_ = *sealed;
        if (!sealed_ && !options_.passphrase_file.empty())
            return failure(program::kExitFailure,
                           options_.file + " has no passphrase: nothing proves who made it");
        const auto size = static_cast<std::uint64_t>(::lseek(text_.number(), 0, SEEK_END));
        auto list = read_list(text_at(0, std::min<std::uint64_t>(size, kMaxListBytes)), size, sealed_);
        if (!list) return tl::unexpected(list.error());
        list_ = std::move(*list);
        environment_.note(for_terminal(options_.file + ": " + list_.about +
                                       (sealed_ ? "" : "; nothing proves that: it has no passphrase")));
        return {};
    }

    std::string text_at(std::uint64_t at, std::uint64_t bytes) const {
        std::string text;
        each_part(text_, at, bytes, [&text](std::string_view part) { return text += part, true; });
        return text;
    }
    std::string text_of(const BackupItem& item) const { return text_at(item.at, item.size); }

    Outcome<What> compare(const BackupMachine& machine, const BackupItem& item) {
        if (!machine.has(item.place))
            return failure(program::kExitFailure,
                           "there is no folder for " + item.path + " here: install the packages first");
        const auto there = machine.look(item);
        if (!there) return tl::unexpected(there.error());
        if (!*there) return What::kNew;
        if (item.is_database())
            return !options_.overwrite && machine.goes_on_here(item) ? What::kNewer : What::kDiffers;
        const auto text = machine.read(item);
        if (!text) return tl::unexpected(text.error());
        if (*text && **text == text_of(item) && ((*there)->st_mode & 0777) == item.mode) return What::kSame;
        const auto changed =
            (*there)->st_mtim.tv_sec * std::int64_t{1'000'000'000} + (*there)->st_mtim.tv_nsec;
        // What agents keep of their boards.
        return item.place == Place::kState && changed > item.changed ? What::kNewer : What::kDiffers;
    }

    /// Says it.
    Outcome<void> plan(const BackupMachine& machine) {
        for (const auto& item : list_.items) {
            if (item.place == Place::kDashboard) {
                report_.did("dashboard", item.path + ": goes to the bus");
                dashboards_ = true;
            }
            if (item.place == Place::kDashboard || options_.dashboards) continue;
            const auto what = compare(machine, item);
            if (!what) return tl::unexpected(what.error());
            if (*what == What::kNew || *what == What::kDiffers) to_write_.push_back(&item);
            if (*what == What::kSame) continue;
            report_.did(kWhatWords.at(static_cast<std::size_t>(*what)),
                        machine.name_of(item) + (*what == What::kNewer ? ": stays as it is here" : "") +
                            (!item.is_database()       ? ""
                             : *what == What::kNewer   ? " (--overwrite: it is replaced)"
                             : *what == What::kDiffers ? ": the one here is replaced"
                                                       : ""));
        }
        return {};
    }

    Outcome<bool> agree(const BackupMachine& machine) {
        if (options_.dry_run) return false;
        if (to_write_.empty() && !dashboards_) return true;
        for (const char* users : {"bus/bus.json", "tokens"}) {
            if (!machine.has(Place::kEtc) || options_.overwrite || options_.dashboards) break;
            const auto there = machine.look({Place::kEtc, users});
            if (!there) return tl::unexpected(there.error());
            if (*there)
                return failure(program::kExitFailure,
                               "this machine has users: " + machine.name_of({Place::kEtc, users}) +
                                   "; nothing was restored. --overwrite: write all that is listed");
        }
        if (options_.yes) return true;
        if (!environment_.terminal() || ::isatty(STDIN_FILENO) == 0)
            return failure(program::kExitUsage,
                           "there is no terminal to ask at; --yes: write all that is listed");
        environment_.out << (sealed_ ? "" : "Nothing proves who made this. ") << "Continue? [y/N] "
                         << std::flush;
        std::string answer;
        std::getline(environment_.in, answer);
        return answer == "y" || answer == "Y" || answer == "yes";
    }

    /// Databases first: one that is in use ends it before anything was written.
    Outcome<void> write(const BackupMachine& machine) {
        if (of_machine()) running_ = running_services();
        if (!running_.empty()) order_units("stop", running_, report_);
        for (const bool database : {true, false}) {
            for (const auto* item : to_write_) {
                if (item->is_database() != database) continue;
                auto done =
                    database ? machine.restore_database(*item, text_) : machine.write(*item, text_of(*item));
                if (!done) return done;
            }
        }
        report_.did("restored", counted(to_write_.size(), "file"));
        return {};
    }

    /// The services and the broker of this machine read what there is now.
    Outcome<void> take_up() {
        const auto folder_path = fs::path(options_.paths.etc) / "bus";
        bool broker = false;
        if (fs::exists(folder_path / "bus.json")) {
            const auto folder = SecureFolder::open(folder_path);
            if (!folder) return tl::unexpected(folder.error());
            const auto bus = folder->bus();
            if (!bus) return tl::unexpected(bus.error());
            broker = is_system_broker(folder->path(), *bus);
            if (of_machine() && broker)
                if (auto done = close_open_listeners(*bus, report_); !done) return done;
            if (of_machine()) become_default(*folder, *bus, report_);
            if (!list_.about.starts_with("made on " + program::host_name() + " "))
                report_.next("if the broker is called by another name now",
                             "asipctl secure renew broker --host HOST");
        }
        if (!of_machine()) {
            report_.next("start the broker, the registry, the gateway and the agents again");
            return {};
        }
        if (broker)
            if (auto done = restart_services(true, {}, report_); !done) return done;
        start_services();
        return {};
    }

    /// The broker of this machine, as its administrator, unless another was named.
    Environment bus() const {
        Environment own = environment_;
        const bool named = std::any_of(
            own.typed_options.begin(), own.typed_options.end(),
            [](const auto& option) { return option.first == "broker" || option.first == "credentials"; });
        const auto admin = options_.paths.etc + "/bus/credentials/admin.credentials";
        program::BrokerOptions options;
        const auto folder = fs::exists(options_.paths.etc + "/bus/bus.json")
                                ? SecureFolder::open(options_.paths.etc + "/bus")
                                : failure(program::kExitFailure, "");
        const auto secured = folder ? folder->bus() : tl::unexpected(folder.error());
        if (named || !secured || !program::take_credentials(options, admin)) return own;
        options.brokers = {mqtt::BrokerAddress{"localhost", secured->port, true}.describe()};
        if (auto mqtt = program::mqtt_options(options, "asipctl")) own.mqtt = std::move(*mqtt);
        own.topics = bus::Topics(options.topic_root);
        return own;
    }

    Outcome<void> put_dashboards() {
        const auto own = bus();
        const auto above = own.topics.root() + "/export/dashboard/";
        std::map<std::string, std::string> wanted;
        for (const auto& item : list_.items)
            if (item.place == Place::kDashboard) wanted[above + item.path] = text_of(item);
        if (wanted.empty()) return {};
        BusSession session(own);
        if (const auto connected = session.connect(); !connected) {
            if (options_.dashboards) return connected;
            report_.did("warning", "dashboards are not there yet: " + connected.error().text);
            report_.next("when the broker runs", "asipctl restore " + options_.file + " --dashboards");
            return {};
        }
        const auto there = read_retained(own, session, {above + "+"});
        if (!there) return tl::unexpected(there.error());
        for (const auto& message : *there) {
            const auto found = wanted.find(message.topic);
            if (found == wanted.end()) continue;
            const bool same = found->second == message.payload;
            if (!same)
                report_.did("differs", "dashboard " + message.topic.substr(above.size()) +
                                           (options_.overwrite ? "" : ": stays as it is here; --overwrite"));
            if (same || !options_.overwrite) wanted.erase(found);
        }
        std::vector<Retained> messages;
        for (const auto& [topic, payload] : wanted)
            messages.push_back({topic, payload});
        if (auto done = put_retained(own, session, messages); !done) return done;
        report_.did("restored", counted(messages.size(), "dashboard"));
        return {};
    }

    const RestoreOptions& options_;
    Environment& environment_;
    SecureReport report_;
    Descriptor text_ = nameless_file();
    bool sealed_ = false;
    BackupList list_;
    std::vector<const BackupItem*> to_write_;
    bool dashboards_ = false;
    Names running_;  // units that this one stops
};

Run declare_restore(Declaration& verb) {
    auto options = std::make_shared<RestoreOptions>();
    verb.argument("FILE", options->file, "What asipctl backup made");
    verb.option("--passphrase-file", "FILE", options->passphrase_file,
                "Its first line is the passphrase (-: standard input); default: it is asked for");
    verb.flag("--dry-run", options->dry_run, "Only say what would be written");
    verb.flag("--yes", options->yes, "Write without a question, for scripts");
    verb.flag("--overwrite", options->overwrite,
              "Also where this machine has users, a history that goes on, and other dashboards");
    verb.flag("--dashboards", options->dashboards, "These alone, when the broker runs");
    declare_paths(verb, options->paths);
    verb.output(options->output, {Output::kText}, {"action", "what", "file", "command"});
    return [options](Environment& environment) {
        const auto done = Restore(*options, environment).run();
        return done ? program::kExitOk : environment.fail_with(done.error());
    };
}

}  // namespace

Verb restore_verb() {
    return {
        "restore", "Bring back what asipctl backup kept, here or on a new machine",
        "Says of each file whether it is new or differs, asks, writes, and starts the services again. Labels "
        "and "
        "links that\nwere changed here later stay as they are. A damaged file restores nothing; no file is "
        "removed.\n"
        "Examples:\n"
        "  asipctl restore bus.backup\n"
        "  asipctl restore bus.backup --dry-run\n"
        "  asipctl restore bus.backup --overwrite --yes --passphrase-file /root/passphrase",
        declare_restore, false};
}

}  // namespace asip::cli
