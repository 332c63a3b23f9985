// SPDX-License-Identifier: Apache-2.0
#include <exception>
#include <iostream>

#include "asip/program/exit_status.hpp"
#include "asip/program/keep_running.hpp"
#include "asip/program/open_files.hpp"
#include "registry/application.hpp"
#include "registry/options.hpp"

int main(int argc, char** argv) {
    asip::program::prepare_process();
    try {
        auto options = asip::registry::read_options(argc, argv);
        if (!options) return options.error();
        return asip::program::keep_running([&options] {
            asip::registry::Application application(*options);
            return application.run();
        });
    } catch (const std::exception& error) {
        std::cerr << "asip-registry: " << error.what() << "\n";
        return asip::program::kExitFailure;
    }
}
