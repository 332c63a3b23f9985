// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <fstream>
#include <stdexcept>
#include <string>

namespace asip::test {

/// A number of /proc/PROCESS/io: "syscr" and "syscw" are system calls that read and wrote, "rchar" is bytes
/// read.
inline std::size_t counted(const std::string& process, const std::string& what) {
    std::ifstream file("/proc/" + process + "/io");
    std::string name;
    for (std::size_t number = 0; file >> name >> number;)
        if (name == what + ":") return number;
    throw std::runtime_error("this system does not count what programs read and write");
}

}  // namespace asip::test
