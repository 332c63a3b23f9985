// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>

#include "tests/cluster/node_engine.hpp"

namespace cluster {
namespace {

/// The programs of a Debian release with RabbitMQ 4, which is newer than this machine's may be. The folder
/// /tmp is that of this machine.
std::vector<std::string> in_root(std::vector<std::string> command) {
    if (!std::filesystem::exists(ASIP_RABBITMQ_ROOT "/usr/lib/rabbitmq"))
        throw std::runtime_error("there is no RabbitMQ in " ASIP_RABBITMQ_ROOT
                                 "; ./run test cluster rabbitmq makes it");
    std::vector<std::string> entered{"unshare",
                                     "--mount",
                                     "sh",
                                     "-c",
                                     "mount --rbind /proc $0/proc && mount --bind /dev $0/dev && mount "
                                     "--bind /tmp $0/tmp && exec chroot $0 \"$@\"",
                                     ASIP_RABBITMQ_ROOT};
    entered.insert(entered.end(), std::make_move_iterator(command.begin()),
                   std::make_move_iterator(command.end()));
    return entered;
}

/// What docs/clusters.md has a reader write for three machines: its first block of that kind.
std::string configuration_of_page() {
    std::ifstream page(ASIP_CLUSTERS_PAGE);
    std::string text, line;
    bool inside = false;
    while (std::getline(page, line)) {
        line.erase(0, line.find_first_not_of(' '));
        if (line == "```" && inside) break;
        if (inside) text += line + "\n";
        inside = inside || line == "```ini";
    }
    return text;
}

/// Three nodes that find each other by a list. They need the name server of Erlang, which is started here so
/// that none is left behind.
class RabbitMq final : public NodeEngine {
  public:
    explicit RabbitMq(const Hosts& hosts) : NodeEngine("rabbitmq", 3, hosts), inner_(free_ports(7)) {
        const auto names = std::to_string(inner_[6]);
        for (std::size_t i = 0; i < (networked() ? ports().size() : 1); ++i) {
            add_helper(in_root({"epmd", "-address", address(i), "-port", names}), i);
            wait_for_port(address(i), inner_[6], last_helper());
        }
        folder().write("enabled_plugins", "[rabbitmq_mqtt].\n");
        for (std::size_t i = 0; i < ports().size(); ++i)
            add_node(in_root({"/usr/lib/rabbitmq/bin/rabbitmq-server"}), environment(i, names));
        wait_for_nodes();
        // As the page says.
        run_helper(in_root({"/usr/lib/rabbitmq/bin/rabbitmqctl", "--erlang-cookie", "asip",
                            "enable_feature_flag", "--opt-in", "khepri_db"}),
                   0, environment(0, names));
    }
    std::vector<std::string> lacks() const override {
        return {"what is retained is known to one node only, and not found by wildcards",
                "wills of a killed node are not published"};
    }

  private:
    std::string node_name(std::size_t node) const {
        return fmt::format("rb{}@{}", node, networked() ? address(node) : "localhost");
    }

    Environment environment(std::size_t node, const std::string& names) const {
        static constexpr std::array kMachines{"rabbit@one", "rabbit@two", "rabbit@three"};
        auto text = configuration_of_page();
        for (std::size_t i = 0; i < ports().size(); ++i) {
            const std::string machine = kMachines.at(i);
            const auto at = text.find(machine);
            if (at == std::string::npos)
                throw std::runtime_error("docs/clusters.md does not name " + machine);
            text.replace(at, machine.size(), node_name(i));
        }
        text += fmt::format(
            "listeners.tcp.1 = {2}:{0}\nmqtt.listeners.tcp.1 = {2}:{1}\nlog.console.level = warning\n"
            "loopback_users = none\n",
            inner_[node], ports()[node], address(node));
        const auto configuration = folder().write(fmt::format("rb{}.conf", node), text);
        const auto own = folder().file(fmt::format("rb{}", node));
        return {{"HOME", folder().path().string()},
                {"RUNNING_UNDER_SYSTEMD", "1"},  // the server in place of its script
                {"NOTIFY_SOCKET", ""},
                {"ERL_EPMD_ADDRESS", address(node)},
                {"ERL_EPMD_PORT", names},
                {"RABBITMQ_NODENAME", node_name(node)},
                {"RABBITMQ_USE_LONGNAME", networked() ? "true" : "false"},
                {"RABBITMQ_CONFIG_FILE", configuration},
                {"RABBITMQ_ENABLED_PLUGINS_FILE", folder().file("enabled_plugins")},
                {"RABBITMQ_DIST_PORT", std::to_string(inner_[3 + node])},
                {"RABBITMQ_MNESIA_BASE", own},
                {"RABBITMQ_LOG_BASE", own},
                {"RABBITMQ_LOGS", "-"},
                {"ERL_CRASH_DUMP_SECONDS", "0"},  // none is left where the harness was started
                {"RABBITMQ_PID_FILE", own + ".pid"},
                {"RABBITMQ_SERVER_ADDITIONAL_ERL_ARGS",
                 "+S 1 +sbwt none +sbwtdcpu none +sbwtdio none -setcookie asip"}};
    }

    std::vector<std::uint16_t> inner_;  // three of AMQP, three between the nodes, one of the name server
};

}  // namespace

std::unique_ptr<Engine> make_rabbitmq(const Hosts& hosts) {
    return std::make_unique<RabbitMq>(hosts);
}

}  // namespace cluster
