// SPDX-License-Identifier: Apache-2.0
#include "tests/support/child_process.hpp"

#include <fcntl.h>
#include <linux/close_range.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <regex>
#include <sstream>
#include <stdexcept>
#include <thread>
#include <utility>

#include "tests/support/temp_dir.hpp"

extern char** environ;

namespace asip::test {
namespace {

struct Pipe {
    int read_end = -1;
    int write_end = -1;

    Pipe() {
        int ends[2];
        if (pipe2(ends, O_CLOEXEC) != 0)
            throw std::runtime_error("pipe: " + std::string(std::strerror(errno)));
        read_end = ends[0];
        write_end = ends[1];
    }
    ~Pipe() {
        if (read_end >= 0) close(read_end);
        if (write_end >= 0) close(write_end);
    }
    int take_read_end() { return std::exchange(read_end, -1); }
    int take_write_end() { return std::exchange(write_end, -1); }
};

/// What a child wrote so far, collected by a thread until the last writer closes its end.
class Capture {
  public:
    void start(int fd) {
        thread_ = std::thread([this, fd] {
            char buffer[4096];
            ssize_t size = 0;
            while ((size = read(fd, buffer, sizeof buffer)) > 0 || (size < 0 && errno == EINTR)) {
                if (size < 0) continue;
                take({buffer, static_cast<std::size_t>(size)});
            }
            close(fd);
            ended_ = true;
        });
    }
    void join() {
        if (thread_.joinable()) thread_.join();
    }
    /// The last writer is gone and text() is whole.
    bool ended() const { return ended_; }
    std::string text() const {
        const std::lock_guard lock(mutex_);
        return text_;
    }
    void on_line(std::function<void(std::string_view)> callback) {
        const std::lock_guard lock(mutex_);
        on_line_ = std::move(callback);
    }

  private:
    void take(std::string_view bytes) {
        const std::lock_guard lock(mutex_);
        auto from = text_.rfind('\n') + 1;  // npos + 1 is the beginning
        text_.append(bytes);
        for (auto end = text_.find('\n', from); on_line_ && end != std::string::npos;
             from = end + 1, end = text_.find('\n', from))
            on_line_(std::string_view(text_).substr(from, end - from));
    }

    mutable std::mutex mutex_;
    std::string text_;
    std::function<void(std::string_view)> on_line_;
    std::atomic<bool> ended_ = false;
    std::thread thread_;
};

bool simulator_under_test = false;

/// A sanitizer's report fails the test whatever the test looks at, and even where the program was to be
/// killed.
void fail_for_sanitizer_report(const std::string& errors) {
    for (const char* mark : {"ERROR: AddressSanitizer", "ERROR: LeakSanitizer", ": runtime error: "}) {
        if (errors.find(mark) == std::string::npos) continue;
        std::fprintf(stderr, "a program under test failed:\n%s\n", errors.c_str());
        std::_Exit(EXIT_FAILURE);
    }
}

// A board has a processor of its own: where we may, its simulator comes before what else is busy.
constexpr int kPriorityOfHardware = -10;
bool stands_for_hardware(const std::string& program) {
    return std::filesystem::path(program).filename() == "asip-sim" && !simulator_under_test;
}

std::vector<char*> pointers(std::vector<std::string>& texts) {
    std::vector<char*> list;
    for (auto& text : texts)
        list.push_back(text.data());
    list.push_back(nullptr);
    return list;
}

std::optional<std::string> find_line(const std::string& text, const std::regex& pattern) {
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);)
        if (std::regex_search(line, pattern)) return line;
    return std::nullopt;
}

}  // namespace

std::vector<std::string> child_environment(const std::map<std::string, std::string>& added) {
    std::vector<std::string> all;
    for (char** entry = environ; *entry != nullptr; ++entry) {
        const std::string text = *entry;
        if (text.starts_with("ASIP_") || text.starts_with("STATE_DIRECTORY=") ||
            text.starts_with("XDG_STATE_HOME=") || added.contains(text.substr(0, text.find('='))))
            continue;
        all.push_back(text);
    }
    // What agents keep (labels, stops that hold) is this process's, not that of the user or of another test.
    static const TempDir state;
    if (!added.contains("HOME") && !added.contains("XDG_STATE_HOME") && !added.contains("STATE_DIRECTORY"))
        all.push_back("XDG_STATE_HOME=" + state.path().string());
    // A board that is simulated on a busy machine is slow to answer.
    if (!added.contains("ASIP_PATIENCE")) all.push_back("ASIP_PATIENCE=30");
    for (const auto& [name, value] : added)
        all.push_back(name + "=" + value);
    return all;
}

std::string program_to_start(const std::string& program) {
    const char* const folder = std::getenv("ASIP_TEST_PROGRAMS");
    if (folder == nullptr || program.find('/') == std::string::npos) return program;
    const auto name = std::filesystem::path(program).filename();
    if (name == "asip-sim" && !simulator_under_test) return program;
    const auto other = std::filesystem::path(folder) / name;
    return std::filesystem::exists(other) ? other.string() : program;
}

struct ChildProcess::State {
    pid_t pid = -1;
    int input = -1;
    Capture output;
    Capture errors;
    std::optional<int> status;

    void reap(bool wait) {
        if (status) return;
        int raw = 0;
        pid_t result = 0;
        do {
            result = waitpid(pid, &raw, wait ? 0 : WNOHANG);
        } while (result < 0 && errno == EINTR);
        if (result == pid) status = WIFSIGNALED(raw) ? 128 + WTERMSIG(raw) : WEXITSTATUS(raw);
    }
};

ChildProcess::ChildProcess(std::vector<std::string> arguments, std::map<std::string, std::string> environment)
    : state_(std::make_unique<State>()) {
    Pipe input, output, errors, failure;
    arguments.at(0) = program_to_start(arguments.at(0));
    auto child_environ = child_environment(environment);
    const auto argv = pointers(arguments);
    const auto envp = pointers(child_environ);
    const pid_t parent = getpid();
    const bool hardware = stands_for_hardware(arguments.at(0));
    state_->pid = fork();
    if (state_->pid < 0) throw std::runtime_error("fork: " + std::string(std::strerror(errno)));
    if (state_->pid == 0) {
        // Only calls that are safe after fork in a program with threads.
        setpgid(0, 0);
        prctl(PR_SET_PDEATHSIG, SIGKILL);
        if (getppid() != parent) _exit(127);
        dup2(input.read_end, 0);
        dup2(output.write_end, 1);
        dup2(errors.write_end, 2);
        // A socket of the test that a child held would keep its port.
        close_range(3, ~0U, CLOSE_RANGE_CLOEXEC);
        if (hardware) setpriority(PRIO_PROCESS, 0, kPriorityOfHardware);
        execvpe(argv[0], argv.data(), envp.data());
        const int problem = errno;
        [[maybe_unused]] const auto written = write(failure.write_end, &problem, sizeof problem);
        _exit(127);
    }
    setpgid(state_->pid, state_->pid);
    close(failure.take_write_end());
    int problem = 0;
    if (read(failure.read_end, &problem, sizeof problem) == sizeof problem) {
        state_->reap(true);
        throw std::runtime_error("cannot start " + arguments[0] + ": " + std::strerror(problem));
    }
    state_->input = input.take_write_end();
    close(output.take_write_end());
    close(errors.take_write_end());
    state_->output.start(output.take_read_end());
    state_->errors.start(errors.take_read_end());
}

ChildProcess::~ChildProcess() {
    close_input();
    ::kill(-state_->pid, SIGKILL);
    state_->reap(true);
    state_->output.join();
    state_->errors.join();
    fail_for_sanitizer_report(state_->errors.text());
}

pid_t ChildProcess::pid() const {
    return state_->pid;
}

void ChildProcess::write_input(const std::string& text) {
    std::size_t done = 0;
    while (done < text.size()) {
        const auto size = ::write(state_->input, text.data() + done, text.size() - done);
        if (size < 0 && errno != EINTR)
            throw std::runtime_error("child's input: " + std::string(std::strerror(errno)));
        if (size > 0) done += static_cast<std::size_t>(size);
    }
}

void ChildProcess::close_input() {
    if (state_->input >= 0) close(std::exchange(state_->input, -1));
}

std::string ChildProcess::output() const {
    return state_->output.text();
}
void ChildProcess::on_output(std::function<void(std::string_view line)> callback) {
    state_->output.on_line(std::move(callback));
}
std::string ChildProcess::errors() const {
    return state_->errors.text();
}

std::optional<std::string> ChildProcess::wait_for_output(const std::string& pattern,
                                                         std::chrono::milliseconds limit) {
    const std::regex regex(pattern);
    wait_until([&] { return find_line(output(), regex).has_value() || !running(); }, limit);
    wait_until([&] { return find_line(output(), regex).has_value(); }, running() ? 0ms : 200ms);
    return find_line(output(), regex);
}

std::optional<std::string> ChildProcess::wait_for_errors(const std::string& pattern,
                                                         std::chrono::milliseconds limit) {
    const std::regex regex(pattern);
    wait_until([&] { return find_line(errors(), regex).has_value() || !running(); }, limit);
    wait_until([&] { return find_line(errors(), regex).has_value(); }, running() ? 0ms : 200ms);
    return find_line(errors(), regex);
}

void ChildProcess::signal(int number) {
    if (running()) ::kill(state_->pid, number);
}

bool ChildProcess::running() {
    state_->reap(false);
    return !state_->status;
}

std::optional<int> ChildProcess::wait_exit(std::chrono::milliseconds limit) {
    wait_until([&] { return !running(); }, limit);
    // What it wrote last may still be in the pipe; a child of its own may hold it open for longer.
    if (state_->status) wait_until([&] { return state_->output.ended() && state_->errors.ended(); }, 1s);
    return state_->status;
}

std::size_t ChildProcess::resident_bytes() const {
    std::ifstream statm("/proc/" + std::to_string(state_->pid) + "/statm");
    std::size_t total = 0, resident = 0;
    statm >> total >> resident;
    return resident * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
}

std::chrono::milliseconds ChildProcess::processor_time() const {
    std::ifstream file("/proc/" + std::to_string(state_->pid) + "/stat");
    std::string text((std::istreambuf_iterator<char>(file)), {});
    // The fields behind the program's name in parentheses; user and system time are the 12th and 13th of
    // them.
    std::istringstream fields(text.substr(text.rfind(')') + 1));
    std::string skipped;
    for (int i = 0; i < 11; ++i)
        fields >> skipped;
    long user = 0, system = 0;
    fields >> user >> system;
    return std::chrono::milliseconds((user + system) * 1000 / sysconf(_SC_CLK_TCK));
}

bool replace_simulator() {
    return simulator_under_test = true;
}

bool other_programs() {
    return std::getenv("ASIP_TEST_PROGRAMS") != nullptr;
}

std::size_t memory_limit(std::size_t bytes) {
    return other_programs() ? std::size_t{2} << 30 : bytes;
}

std::chrono::milliseconds time_limit(std::chrono::milliseconds time) {
    return (other_programs() ? 10 : 5) * time;
}

Finished run(std::vector<std::string> arguments, std::map<std::string, std::string> environment,
             std::chrono::milliseconds limit) {
    ChildProcess child(std::move(arguments), std::move(environment));
    child.close_input();
    Finished finished;
    const auto status = child.wait_exit(limit);
    finished.status = status.value_or(-1);
    if (!status) child.signal(SIGKILL);
    finished.output = child.output();
    finished.errors = child.errors();
    return finished;
}

}  // namespace asip::test
