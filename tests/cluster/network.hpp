// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <sys/types.h>

#include <chrono>
#include <memory>
#include <string>
#include <vector>

namespace cluster {

/// What the network between some hosts and all others does to their packets. Within the group nothing is
/// done.
struct Weather {
    bool drops_out = false;                 ///< what the group sends
    bool drops_in = false;                  ///< what is sent to it
    double loss = 0;                        ///< of each packet, both ways, 0 to 1
    std::chrono::milliseconds delay{0};     ///< of what the group sends
    std::chrono::milliseconds flapping{0};  ///< as long cut both ways, as long whole, and so on; zero: not
};

/// Hosts, each a network namespace of its own with one interface. Their packets go through this process,
/// which drops and delays them; kernels without `tc netem` do as well. Nothing of it has a name, so nothing
/// is left behind, however the process ends.
class Network {
  public:
    /// Host 0 is this process, with what it starts without inside(). Host 1 is this process under another
    /// address, which no weather reaches: what is wired to the hosts by other means than this network.
    enum : std::size_t { kHere = 0, kWired = 1, kFirst = 2 };

    /// Empty where hosts can be made; else why not, in words.
    static std::string impossible();
    /// Moves this process into a namespace of its own. To be made before its first thread, once. Throws
    /// std::system_error.
    explicit Network(std::size_t hosts);
    ~Network();
    Network(const Network&) = delete;
    Network& operator=(const Network&) = delete;

    /// "10.77.0.3"
    static std::string address(std::size_t host);
    /// The command that starts this one inside a host. It keeps its process id.
    std::vector<std::string> inside(std::size_t host, std::vector<std::string> command) const;

    /// From now on, in place of what was for these hosts.
    void set(const std::vector<std::size_t>& group, const Weather& weather);
    void clear(const std::vector<std::size_t>& group);

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace cluster
