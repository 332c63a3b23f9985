// SPDX-License-Identifier: Apache-2.0
#include "agent/program/program.hpp"

#include <exception>
#include <iostream>
#include <string>
#include <vector>

#include "agent/inbound/continuations.hpp"
#include "agent/program/plan.hpp"
#include "agent/program/supervisor.hpp"
#include "asip/program/exit_status.hpp"

namespace asip::agent {

int run_program(int argc, const char* const* argv) {
    try {
        auto plan = read_plan(argc, argv);
        if (!plan) return plan.error();
        auto read_again = [file = plan->file, arguments = std::vector<std::string>(argv + 1, argv + argc)] {
            return plan_of_file(file, arguments);
        };
        count_continuations();
        Supervisor supervisor(std::move(*plan), std::move(read_again));
        return supervisor.run();
    } catch (const std::exception& error) {
        std::cerr << "asip-agent: " << error.what() << "\n";
        return program::kExitFailure;
    }
}

}  // namespace asip::agent
