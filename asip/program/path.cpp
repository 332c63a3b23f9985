// SPDX-License-Identifier: Apache-2.0
#include "asip/program/path.hpp"

#include <unistd.h>

#include <sstream>

#include "asip/program/options.hpp"

namespace asip::program {

bool is_program(const std::string& path) {
    return ::access(path.c_str(), X_OK) == 0;
}

bool is_in_path(const std::string& name) {
    std::istringstream folders(environment_variable("PATH").value_or(""));
    for (std::string folder; std::getline(folders, folder, ':');)
        if (!folder.empty() && is_program(folder + "/" + name)) return true;
    return false;
}

}  // namespace asip::program
