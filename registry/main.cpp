// SPDX-License-Identifier: Apache-2.0
#include "asip/program/open_files.hpp"
#include "registry/program.hpp"

int main(int argc, char** argv) {
    asip::program::prepare_process();
    return asip::registry::run_program(argc, argv);
}
