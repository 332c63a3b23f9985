// SPDX-License-Identifier: Apache-2.0
#include "agent/program/plan.hpp"

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <map>

#include "agent/program/options.hpp"
#include "asip/program/app.hpp"
#include "asip/program/config_file.hpp"
#include "asip/program/exit_status.hpp"

namespace asip::agent {

namespace {

constexpr const char* kProgram = "asip-agent";
constexpr const char* kSection = "board";

constexpr const char* kAbout =
    "Puts one ASIP board on the service bus: announces it with its services, bridges its events and "
    "commands,\n"
    "and keeps doing so when the board or the broker leaves and comes back.";

constexpr const char* kExamples =
    "Examples:\n"
    "  asip-agent --serial /dev/ttyACM0\n"
    "      The board at that port, to the broker on this machine, under the name stored on the board.\n"
    "  asip-agent --serial /dev/ttyUSB0 --name greenhouse --broker broker.local,backup.local\n"
    "      Two brokers: the second is used while the first does not answer.\n"
    "  asip-agent --tcp 192.168.1.20:5005 --broker mqtts://broker.local --user pi --password-file ~/.asip\n"
    "      A board with a network of its own; encrypted to the broker.\n"
    "  asip-agent --serial /dev/ttyACM0 --label room=lab,floor=2\n"
    "      Labels by which asipctl and programs choose boards.\n"
    "  asip-agent --serial /dev/ttyACM0 --reports on-demand\n"
    "      Values as often as programs want them, and none while no program does.\n"
    "  asip-agent --serial /dev/ttyACM0 --listen 6789\n"
    "      Clients without MQTT may connect to port 6789, with plain lines or Java's writeUTF frames.\n"
    "  asip-agent --config /etc/asip/boards.conf\n"
    "      Several boards, one for each section of the file:\n"
    "          broker = broker.local\n"
    "          [board greenhouse]\n"
    "          serial = /dev/serial/by-id/usb-Arduino_LLC_Arduino_Leonardo-if00\n"
    "          [board porch]\n"
    "          tcp = 192.168.1.20:5005\n"
    "  asip-agent --cables /run/asip/cables\n"
    "      Boards that browsers lend at the page of asip-gateway --cables /run/asip/cables.\n"
    "\n"
    "Exit status: 0 stopped by a signal; 1 cannot listen for clients, or failed while running;\n"
    "2 bad option; 3 the broker refused the connection; 5 port busy, no permission, or no ASIP board\n"
    "there; 6 another agent holds the board's name. With several boards 1, 3, 5 and 6 end none but\n"
    "that one, which is started again.";

// What belongs to one board, so that it cannot be said for all of them.
struct OfOneBoard {
    const char* name;
    bool given;
};

std::vector<OfOneBoard> of_one_board(const RawOptions& raw) {
    return {{"serial", !raw.serial.empty()},
            {"tcp", !raw.tcp.empty()},
            {"name", !raw.name.empty()},
            {"listen", !raw.listen.empty()},
            {"cables", !raw.cables.empty()}};
}

Unexpected<int> usage_error(const std::string& text) {
    std::cerr << kProgram << ": " << text << "\n";
    return Unexpected<int>(program::kExitUsage);
}

/// What stands above the sections, but for what the section says itself.
std::vector<program::ConfigLine> lines_of(const program::ConfigFile& file,
                                          const program::ConfigSection& section) {
    auto lines = section.lines;
    for (const auto& line : file.lines)
        if (std::none_of(section.lines.begin(), section.lines.end(),
                         [&](const auto& own) { return own.name == line.name; }))
            lines.push_back(line);
    if (!section.title.empty()) lines.push_back({section.number, "name", section.title});
    return lines;
}

std::string port_of(const AgentOptions& options) {
    if (!options.tcp.empty()) return "tcp://" + options.tcp;
    std::error_code error;
    const auto real = std::filesystem::weakly_canonical(options.serial, error);
    return error ? options.serial : real.string();
}

/// Finds what two boards cannot share.
class Shared {
  public:
    /// Fails where a board before it has `thing`, which is called `what`.
    Expected<void> take(const std::string& thing, const std::string& what, int line) {
        const auto [known, added] = taken_.emplace(thing, line);
        if (added) return {};
        return fail(what + " is that of the board of line " + std::to_string(known->second) + ", too");
    }

    Expected<void> take_all(const AgentOptions& options, int line) {
        if (const std::string& name = options.bridge.name; !name.empty())
            if (auto free = take("name " + name, "the name " + name, line); !free) return free;
        const std::string where = options.serial.empty() ? options.tcp : options.serial;
        if (auto free = take(port_of(options), "the port " + where, line); !free) return free;
        for (const auto& listen : options.listen) {
            if (listen.address.port == 0) continue;
            const auto port = std::to_string(listen.address.port);
            if (auto free = take("listen " + listen.address.host + " " + port,
                                 "the address " + listen.address.host + ":" + port + " for clients", line);
                !free)
                return free;
        }
        return {};
    }

  private:
    std::map<std::string, int> taken_;
};

class SectionReader {
  public:
    SectionReader(const std::string& path, const std::vector<std::string>& arguments)
        : path_(path), arguments_(arguments) {}

    Expected<PlannedBoard> read(const program::ConfigFile& file, const program::ConfigSection& section) {
        const auto lines = lines_of(file, section);
        if (const auto fits = check_names(section); !fits) return fail(fits.error());
        program::App app{"", kProgram};
        program::Settings settings(app, kProgram);
        RawOptions raw;
        declare_options(app, settings, raw);
        if (const auto parsed = settings.parse_section(arguments_, path_, lines); !parsed)
            return fail(parsed.error());
        const std::string folder = raw.services;
        auto options = checked_options(std::move(raw));
        if (options && !section.title.empty() && options->bridge.name != section.title)
            options = fail("the credentials are for board " + options->bridge.name);
        if (!options) return fail(at(section.number, options.error()));
        const auto models = models_.find(folder);
        auto loaded = models == models_.end() ? load_models(folder) : models->second;
        if (!loaded) return fail(at(section.number, loaded.error()));
        options->models = *models_.insert_or_assign(folder, std::move(loaded)).first->second;
        if (const auto free = shared_.take_all(*options, section.number); !free)
            return fail(at(section.number, free.error()));
        PlannedBoard board{options->bridge.name.empty() ? port_of(*options) : options->bridge.name, {}, {}};
        for (const auto& line : lines)
            board.text += line.name + "=" + line.value + "\n";
        board.options = std::move(*options);
        return board;
    }

  private:
    std::string at(int line, const std::string& text) const {
        return path_ + ":" + std::to_string(line) + ": " + text;
    }

    Expected<void> check_names(const program::ConfigSection& section) const {
        for (const auto& line : section.lines) {
            if (line.name == "name")
                return fail(at(line.number, "the name of a board stands in the section's title: [board " +
                                                line.value + "]"));
            if (line.name == "cables")
                return fail(at(line.number, "boards that browsers lend have an agent of their own"));
            if (line.name == "log-level" || line.name == "log-format")
                return fail(at(line.number, line.name + " holds for all boards: put it above the sections"));
        }
        return {};
    }

    const std::string& path_;
    const std::vector<std::string>& arguments_;
    std::map<std::string, Expected<model::ModelSet>> models_;
    Shared shared_;
};

}  // namespace

Expected<Plan> plan_of_file(const std::string& path, const std::vector<std::string>& arguments) {
    const auto file = program::read_config_file(path, kProgram, kSection);
    if (!file) return fail(file.error());
    if (file->sections.empty()) return fail(path + " has no section [board NAME]");
    Plan plan;
    plan.file = path;
    SectionReader reader(path, arguments);
    for (const auto& section : file->sections) {
        auto board = reader.read(*file, section);
        if (!board) return fail(board.error());
        plan.boards.push_back(std::move(*board));
    }
    return plan;
}

Expected<Plan, int> read_plan(int argc, const char* const* argv) {
    program::App app{kAbout, kProgram};
    app.footer(kExamples);
    program::Settings settings(app, kProgram);
    settings.allow_sections(kSection);
    RawOptions raw;
    declare_options(app, settings, raw);
    if (const auto status = settings.parse(argc, argv)) return Unexpected<int>(*status);

    if (!settings.config_file().sections.empty()) {
        const std::string& path = settings.config_path();
        for (const auto& [name, given] : of_one_board(raw))
            if (given)
                return usage_error(path + " has sections [board NAME], so that --" + name +
                                   " belongs into them; for one board alone give another file");
        auto plan = plan_of_file(path, {argv + std::min(argc, 1), argv + argc});
        return plan ? Expected<Plan, int>(std::move(*plan)) : usage_error(plan.error());
    }
    auto models = load_models(raw.services);
    if (!models) return usage_error(models.error());
    const std::string cables = raw.cables;
    auto options = checked_options(std::move(raw));
    if (!options) return usage_error(options.error());
    options->models = std::move(*models);
    Plan plan;
    if (cables.empty())
        plan.boards.push_back({{}, {}, std::move(*options)});
    else
        plan.lending = Lending{cables, std::move(*options)};
    return plan;
}

}  // namespace asip::agent
