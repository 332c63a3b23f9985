// SPDX-License-Identifier: Apache-2.0
#include <exception>
#include <iostream>

#include "agent/application.hpp"
#include "agent/options.hpp"
#include "asip/program/exit_status.hpp"

int main(int argc, char** argv) {
    try {
        auto options = asip::agent::read_options(argc, argv);
        if (!options) return options.error();
        asip::agent::Application application(std::move(*options));
        return application.run();
    } catch (const std::exception& error) {
        std::cerr << "asip-agent: " << error.what() << "\n";
        return asip::program::kExitFailure;
    }
}
