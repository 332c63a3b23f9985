// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <sys/types.h>

#include <chrono>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tests/support/wait.hpp"

namespace asip::test {

/// A program under test. Killed, with whatever it started, when this object goes; killed by the kernel when
/// the test dies. What a sanitizer reported of it ends the test with a failure.
class ChildProcess {
  public:
    /// `arguments[0]` is the program: a path, or looked up in PATH. For a path, a program of the same name in
    /// the folder ASIP_TEST_PROGRAMS is started instead, where that variable names one; not for asip-sim,
    /// unless replace_simulator() was called. `environment` is added to the test's own, from which all ASIP_
    /// variables are taken out; agents get a patience of 30 s with their board. Throws std::runtime_error
    /// when it cannot be started.
    explicit ChildProcess(std::vector<std::string> arguments,
                          std::map<std::string, std::string> environment = {});
    ~ChildProcess();
    ChildProcess(const ChildProcess&) = delete;
    ChildProcess& operator=(const ChildProcess&) = delete;

    pid_t pid() const;

    void write_input(const std::string& text);
    void close_input();

    /// Everything it has written so far. The streams are read by threads, so that it never blocks on a full
    /// pipe.
    std::string output() const;  ///< standard output
    std::string errors() const;  ///< standard error

    /// From now on `callback` gets each line of standard output as it comes, for a test that needs to know
    /// when. It is called by another thread, must not call this object, and outlives it or is replaced by an
    /// empty one.
    void on_output(std::function<void(std::string_view line)> callback);

    /// The first line of standard output (or error) that contains a match of the ECMAScript regular
    /// expression. Nothing when none came in time.
    std::optional<std::string> wait_for_output(const std::string& pattern,
                                               std::chrono::milliseconds limit = kDeadline);
    std::optional<std::string> wait_for_errors(const std::string& pattern,
                                               std::chrono::milliseconds limit = kDeadline);

    void signal(int number);
    bool running();
    /// Its exit status (128 + signal when killed by one); nothing when it still runs after `limit`.
    std::optional<int> wait_exit(std::chrono::milliseconds limit = kDeadline);

    /// Resident memory in bytes, and processor time used so far.
    std::size_t resident_bytes() const;
    std::chrono::milliseconds processor_time() const;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

/// To most tests asip-sim is the world, which has to keep up with real time; a sanitized one is too slow for
/// 1 Mbaud. Tests of asip-sim itself call this, so that ASIP_TEST_PROGRAMS replaces it, too. Returns true.
bool replace_simulator();

/// Whether ASIP_TEST_PROGRAMS puts other programs in place.
bool other_programs();

/// Limits for programs that ASIP_TEST_PROGRAMS puts in place, such as sanitized ones: those keep freed memory
/// and are slower. `bytes` as they are, where no other programs are put in place; `time`, which is what a
/// quiet machine needs at most, five times as long, for one that is busy.
std::size_t memory_limit(std::size_t bytes);
std::chrono::milliseconds time_limit(std::chrono::milliseconds time);

/// Which program is started for `program`, and in which environment, as ChildProcess says: for a test that
/// starts one in another way.
std::string program_to_start(const std::string& program);
std::vector<std::string> child_environment(const std::map<std::string, std::string>& added);

struct Finished {
    int status = -1;  ///< -1: did not end in time and was killed
    std::string output;
    std::string errors;
};

/// Runs a program to its end.
Finished run(std::vector<std::string> arguments, std::map<std::string, std::string> environment = {},
             std::chrono::milliseconds limit = kDeadline);

}  // namespace asip::test
