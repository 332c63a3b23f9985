// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "tests/support/child_process.hpp"

namespace cluster {

/// A program that is killed and started again, and all that it logged.
class Process {
  public:
    explicit Process(std::vector<std::string> command, std::map<std::string, std::string> environment = {});

    void start();  ///< also again, after a kill
    void kill();   ///< SIGKILL, and its end
    void stop();   ///< SIGSTOP
    void go_on();  ///< SIGCONT
    /// SIGTERM, and its end.
    void say_goodbye();

    /// Its exit status, where it was not killed and yet has ended.
    std::optional<int> ended_by_itself();
    std::string log() const;

  private:
    std::vector<std::string> command_;
    std::map<std::string, std::string> environment_;
    std::unique_ptr<asip::test::ChildProcess> process_;
    std::string earlier_;
};

}  // namespace cluster
