// SPDX-License-Identifier: Apache-2.0
#include "asip/model/port_name.hpp"

#include <gtest/gtest.h>

namespace asip::model {
namespace {

TEST(PortName, PortById_IsThatName) {
    EXPECT_EQ(name_of_port("/dev/serial/by-id/usb-Arduino__www.arduino.cc__0043_7583-if00", "lab"),
              "usb-Arduino__www.arduino.cc__0043_7583-if00");
    EXPECT_EQ(name_of_port("/dev/ttyACM0", "lab"), "ttyACM0");
}

TEST(PortName, PortByPath_IsMachineControllerAndSocket) {
    EXPECT_EQ(name_of_port("/dev/serial/by-path/pci-0000:00:14.0-usb-0:3:1.0-port0", "lab"), "lab-usb-140-3");
    EXPECT_EQ(name_of_port("/dev/serial/by-path/pci-0000:00:1a.0-usb-0:3:1.0-port0", "lab"), "lab-usb-1a0-3")
        << "another controller";
    EXPECT_EQ(name_of_port("/dev/serial/by-path/platform-fd500000.pcie-pci-0000:01:00.0-usb-0:1.3:1.0-port0",
                           "pi.local"),
              "pi-usb-000-1.3");
    EXPECT_EQ(name_of_port("/dev/serial/by-path/platform-3f980000.usb-usb-0:1.4:1.0", "pi"),
              "pi-usb-000-1.4");
    EXPECT_EQ(name_of_port("/dev/serial/by-path/pci-0000:00:14.0-usb-0:3:1.1-port0", "lab"),
              "lab-usb-140-3-1.1");
    EXPECT_EQ(name_of_port("/dev/serial/by-path/pci-0000:00:14.0-usb-0:3:1.0-port1", "lab"),
              "lab-usb-140-3-1.0-port1");
}

TEST(PortName, OddPath_IsAValidNameAllTheSame) {
    for (const auto* path :
         {"/dev/serial/by-path/", "/dev/serial/by-path/pci-usb-0",
          "/dev/serial/by-path/-usb-:", "/dev/serial/by-path/-usb-::", "", "/x-usb-0:1:1.0/by-path/y"})
        EXPECT_FALSE(name_of_port(path, "lab").empty()) << path;
}

}  // namespace
}  // namespace asip::model
