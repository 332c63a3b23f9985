// SPDX-License-Identifier: Apache-2.0
#include <exception>
#include <iostream>

#include "asip/program/exit_status.hpp"
#include "asip/program/open_files.hpp"
#include "gateway/application.hpp"
#include "gateway/options.hpp"
#include "gateway/running_exports.hpp"

int main(int argc, char** argv) {
    asip::program::prepare_process();
    try {
        auto line = asip::gateway::read_options(argc, argv);
        if (!line) return line.error();
        if (line->token) return asip::gateway::make_token(*line->token);
        if (line->export_switch) return asip::gateway::switch_export(*line->export_switch);
        if (line->clean) return asip::gateway::clean_exports(line->run.exports, line->run.mqtt);
        asip::gateway::Application application(std::move(line->run));
        return application.run();
    } catch (const std::exception& error) {
        std::cerr << "asip-gateway: " << error.what() << "\n";
        return asip::program::kExitFailure;
    }
}
