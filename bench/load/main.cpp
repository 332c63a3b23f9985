// SPDX-License-Identifier: Apache-2.0
#include <exception>
#include <iostream>

#include "asip/program/exit_status.hpp"
#include "asip/program/open_files.hpp"
#include "bench/load/application.hpp"
#include "bench/load/options.hpp"

int main(int argc, char** argv) {
    asip::program::prepare_process();
    try {
        auto options = asip::load::read_options(argc, argv);
        if (!options) return options.error();
        asip::load::Application application(std::move(*options));
        return application.run();
    } catch (const std::exception& error) {
        std::cerr << "asip-load: " << error.what() << "\n";
        return asip::program::kExitFailure;
    }
}
