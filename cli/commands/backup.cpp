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
        auto items = machine.list([this](const std::string& why) { environment_.note("left out: " + why); });
        if (!items) return tl::unexpected(items.error());
        std::size_t secrets = 0;
        for (auto& item : *items) {
            if (options_.without_secrets && item.is_secret()) {
                ++secrets;
            } else if (item.is_database()) {
                auto copy = machine.copy_database(item);
                if (!copy) return tl::unexpected(copy.error());
                item.size = static_cast<std::uint64_t>(::lseek(copy->number(), 0, SEEK_END));
                add(std::move(item), {"", std::move(*copy)});
            } else {
                auto text = machine.read(item);
                if (!text) return tl::unexpected(text.error());
                item.size = text->size();
                add(std::move(item), {std::move(*text)});
            }
        }
        if (secrets > 0) environment_.note("left out: " + counted(secrets, "file") + " with keys and users");
        return {};
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
            if (item.valid()) add(std::move(item), {std::move(payload)});
        }
        return {};
    }

    /// What an item has: its text, or that of a file.
    struct Content {
        std::string text;
        program::Descriptor file{};
    };
    void add(BackupItem item, Content content) {
        items_.push_back(std::move(item));
        contents_.push_back(std::move(content));
    }

    Outcome<void> produce(const Sink& sink) {
        const auto text = to_text("made on " + program::host_name() + " at " +
                                      text::iso_time(text::wall_now()) + " by asipctl " ASIP_VERSION,
                                  items_);
        if (text.size() > kMaxListBytes) return failure(program::kExitFailure, "these are too many files");
        sink(text);
        for (std::size_t i = 0; i < items_.size(); ++i) {
            const auto& [own, file] = contents_[i];
            if (file.valid() ? !each_part(file, 0, items_[i].size, sink) : !sink(own))
                return failure(program::kExitFailure, items_[i].path + " cannot be read to its end");
        }
        return {};
    }

    Outcome<void> write(const Passphrase& passphrase) {
        std::string draft = options_.file + ".XXXXXX";
        const program::Descriptor out(::mkostemp(draft.data(), O_CLOEXEC));  // 0600
        const auto cannot = [this] {
            return failure(program::kExitFailure,
                           "cannot write " + options_.file + ": " + std::strerror(errno));
        };
        if (!out.valid()) return cannot();
        auto done = seal(out, passphrase, [this](const Sink& sink) { return produce(sink); });
        if (done && ::rename(draft.c_str(), options_.file.c_str()) != 0) done = cannot();
        if (!done) ::unlink(draft.c_str());
        const auto above = fs::absolute(options_.file).parent_path();
        const program::Descriptor folder(::open(above.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
        if (done && (!folder.valid() || !folder.sync())) return cannot();
        return done;
    }

    const BackupOptions& options_;
    Environment& environment_;
    std::vector<BackupItem> items_;
    std::vector<Content> contents_;
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
