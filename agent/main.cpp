// SPDX-License-Identifier: Apache-2.0
#include "agent/program/program.hpp"
#include "asip/program/open_files.hpp"

int main(int argc, char** argv) {
    asip::program::prepare_process();
    return asip::agent::run_program(argc, argv);
}
