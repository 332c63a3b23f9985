// SPDX-License-Identifier: Apache-2.0
#include "gateway/program.hpp"

#include <exception>
#include <iostream>

#include "asip/program/exit_status.hpp"
#include "gateway/application.hpp"
#include "gateway/options.hpp"
#include "gateway/running_exports.hpp"

namespace asip::gateway {

int run_program(int argc, const char* const* argv) {
    try {
        auto line = read_options(argc, argv);
        if (!line) return line.error();
        if (line->token) return make_token(*line->token);
        if (line->export_switch) return switch_export(*line->export_switch);
        if (line->clean) return clean_exports(line->run.exports, line->run.mqtt);
        Application application(std::move(line->run));
        return application.run();
    } catch (const std::exception& error) {
        std::cerr << "asip-gateway: " << error.what() << "\n";
        return program::kExitFailure;
    }
}

}  // namespace asip::gateway
