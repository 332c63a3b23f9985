// SPDX-License-Identifier: Apache-2.0
#include <iostream>

#include "asip/program/open_files.hpp"
#include "cli/app.hpp"

int main(int argc, char** argv) {
    asip::program::prepare_process();
    std::ios::sync_with_stdio(false);
    return asip::cli::run_app(asip::cli::all_verbs(), argc, argv, std::cin, std::cout, std::cerr);
}
