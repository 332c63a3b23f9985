// SPDX-License-Identifier: Apache-2.0
#include "asip/program/open_files.hpp"
#include "gateway/program.hpp"

int main(int argc, char** argv) {
    asip::program::prepare_process();
    return asip::gateway::run_program(argc, argv);
}
