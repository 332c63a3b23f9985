// SPDX-License-Identifier: Apache-2.0
#include "agent/program.hpp"

int main(int argc, char** argv) {
    return asip::agent::run_program(argc, argv);
}
