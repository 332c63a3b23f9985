// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <string_view>

#include "asip/bus/request/reply.hpp"
#include "cli/ask/bus_session.hpp"
#include "cli/environment.hpp"
#include "cli/find/target.hpp"
#include "cli/output.hpp"

namespace asip::cli {

struct LoadOptions {
    std::string firmware = "AsipServices";
    std::string board;    ///< which kind it is; empty: its agent finds out
    bool force = false;   ///< also where it runs ASIP
    bool update = false;  ///< instead of all: what it runs, where its agent has a newer version
};

/// An agent that was asked to load firmware of its machine into its board. It lives until the answer came.
class Load {
  public:
    Load(const Environment& environment, BusSession& session, const std::string& board,
         const LoadOptions& options);
    Load(const Load&) = delete;
    Load& operator=(const Load&) = delete;

    /// The answer, once it is there, or says that none came.
    const std::optional<bus::Reply>& reply() const { return reply_; }
    /// What the description of the board says of it meanwhile: "writing 40 %". Empty: nothing.
    static std::string progress(std::string_view description);

  private:
    std::optional<bus::Reply> reply_;
    BusSession::Call call_;
};

/// `asipctl flash BOARD`: prints progress and result.
int run_load(const LoadOptions& options, const std::string& board, const OutputOptions& output,
             Environment& environment);

/// What `asipctl flash --class` does, until Ctrl-C.
struct ClassOptions {
    LoadOptions load{};
    std::optional<std::string> names;  ///< with {} for the number
    std::string host;                  ///< of the boards; `*`: all
    std::size_t count = 0;             ///< it ends when so many boards run the firmware; 0: at Ctrl-C
    OutputOptions output{};
};
int run_class(const ClassOptions& options, Environment& environment);

/// What `asipctl flash --update` does: it ends with the last board, or behind the third that fails.
struct UpdateOptions {
    Target target;
    bus::LabelSelector labels;
    OutputOptions output{};
};
int run_update(const UpdateOptions& options, Environment& environment);

}  // namespace asip::cli
