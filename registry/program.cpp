// SPDX-License-Identifier: Apache-2.0
#include "registry/program.hpp"

#include <exception>
#include <iostream>

#include "asip/program/exit_status.hpp"
#include "asip/program/keep_running.hpp"
#include "registry/application.hpp"
#include "registry/options.hpp"

namespace asip::registry {

int run_program(int argc, const char* const* argv) {
    try {
        auto options = read_options(argc, argv);
        if (!options) return options.error();
        return program::keep_running([&options] {
            Application application(*options);
            return application.run();
        });
    } catch (const std::exception& error) {
        std::cerr << "asip-registry: " << error.what() << "\n";
        return program::kExitFailure;
    }
}

}  // namespace asip::registry
