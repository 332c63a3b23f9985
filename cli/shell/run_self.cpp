// SPDX-License-Identifier: Apache-2.0
#include "cli/shell/run_self.hpp"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <termios.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>

namespace asip::cli {
namespace {

/// As long as it lives, the terminal writes no `^C`.
class QuietTerminal {
  public:
    explicit QuietTerminal(bool on) : on_(on && tcgetattr(STDIN_FILENO, &settings_) == 0) {
        auto quiet = settings_;
        quiet.c_lflag &= ~static_cast<tcflag_t>(ECHOCTL);
        if (on_) tcsetattr(STDIN_FILENO, TCSADRAIN, &quiet);
    }
    ~QuietTerminal() {
        if (on_) tcsetattr(STDIN_FILENO, TCSADRAIN, &settings_);
    }
    QuietTerminal(const QuietTerminal&) = delete;
    QuietTerminal& operator=(const QuietTerminal&) = delete;

  private:
    termios settings_{};
    bool on_;
};

/// As long as it lives, no signal is taken: a child is not to run our handlers.
class SignalsWait {
  public:
    SignalsWait() {
        sigset_t all;
        sigfillset(&all);
        sigprocmask(SIG_SETMASK, &all, &before_);
    }
    ~SignalsWait() { sigprocmask(SIG_SETMASK, &before_, nullptr); }
    SignalsWait(const SignalsWait&) = delete;
    SignalsWait& operator=(const SignalsWait&) = delete;

  private:
    sigset_t before_{};
};

[[noreturn]] void become(char* const* arguments, bool with_input, pid_t parent) {
    prctl(PR_SET_PDEATHSIG, SIGTERM);
    if (getppid() != parent) _exit(128 + SIGTERM);
    for (const int number : {SIGINT, SIGQUIT, SIGTERM, SIGPIPE})
        signal(number, SIG_DFL);
    sigset_t none;
    sigemptyset(&none);
    sigprocmask(SIG_SETMASK, &none, nullptr);
    if (!with_input) {
        const int nothing = open("/dev/null", O_RDONLY);
        if (nothing < 0 || dup2(nothing, STDIN_FILENO) < 0) _exit(126);
    }
    execv("/proc/self/exe", arguments);
    _exit(127);
}

int status_of(int status) {
    return WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
}

}  // namespace

Expected<int> run_self(const SelfRun& run) {
    std::string program = "asipctl";
    auto words = run.arguments;
    std::vector<char*> arguments{program.data()};
    for (auto& word : words)
        arguments.push_back(word.data());
    arguments.push_back(nullptr);
    const QuietTerminal quiet(run.with_input);
    const auto parent = getpid();
    pid_t pid = -1;
    {
        const SignalsWait wait;
        pid = fork();
        if (pid == 0) become(arguments.data(), run.with_input, parent);
    }
    if (pid < 0) return fail(std::string("cannot start a command: ") + std::strerror(errno));
    int status = 0;
    bool gone = false;
    const auto ended = [&] {
        if (!gone) gone = waitpid(pid, &status, WNOHANG) != 0;
        return gone;
    };
    if (run.wait) {
        run.wait(ended);
        if (!ended()) kill(pid, SIGTERM);
    }
    while (!gone)
        gone = waitpid(pid, &status, 0) == pid || errno != EINTR;
    return status_of(status);
}

}  // namespace asip::cli
